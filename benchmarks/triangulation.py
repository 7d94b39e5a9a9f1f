"""Does a rig's sigma foretell the error of a triangulated point?

Each run holds a board at several places before three cameras, calibrates everything in one bundle from noisy
corners (each camera first by itself, as `vr extrinsics rig` does), and triangulates points from fresh noisy
pixels.
`ratio` is the rms of error in units of its own covariance: 1 where that is honest.
"""

import argparse

import numpy as np
from synthetic import board_points, some_camera
from table import markdown, shown

from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.errors import VisionRobotError
from vision_robot.evaluate.rig import rig_error
from vision_robot.extrinsics.rig import fit_rig
from vision_robot.geometry import SE3, CameraRig, KnownCamera, rotation_exp

NAMES = ("left", "right", "top")


def asked() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--runs", type=int, default=40)
    parser.add_argument("--moments", type=int, default=16)
    parser.add_argument("--points", type=int, default=50, help="triangulated in each run")
    parser.add_argument("--noise", type=float, default=0.2, help="one sigma of a corner per axis [px]")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="two runs: only to see that it runs")
    return parser.parse_args()


def some_rig(rng: np.random.Generator) -> CameraRig:
    """Three cameras a hand's breadth to an arm's length apart that look at one place."""
    cameras = tuple(some_camera(rng) for _ in NAMES)
    size = float(np.ptp(board_points()[:, 0]))
    target = np.array([0.2 * size, 0.0, 2.6 * size])
    rotations, translations = [np.eye(3)], [np.zeros(3)]
    for base in ([1.2, 0.0, 0.1], [0.4, -1.1, 0.2]):
        eye = size * (np.array(base) + rng.uniform(-0.2, 0.2, 3))
        forward = (target - eye) / np.linalg.norm(target - eye)
        right = np.cross([0, 1.0, 0], forward)
        right /= np.linalg.norm(right)
        rotations.append(np.stack([right, np.cross(forward, right), forward]))
        translations.append(-rotations[-1] @ eye)
    return CameraRig.exact(NAMES, cameras, SE3(np.array(rotations), np.array(translations)))


def one_run(seed: int, options: argparse.Namespace) -> tuple[float, float, float]:
    """Mean squared error in units of the covariance, rms error and foretold rms [mm]."""
    rng = np.random.default_rng([seed, 8])
    truth, board = some_rig(rng), board_points()
    size = float(np.ptp(board[:, 0]))
    sightings: list[dict[str, Corners]] = [{} for _ in NAMES]
    held = []
    for _ in range(100 * options.moments):
        if len(held) == options.moments:
            break
        turn = rotation_exp(rng.normal(size=3) * 0.4)
        middle = size * rng.uniform([-0.4, -0.5, 2.0], [0.8, 0.5, 3.2])
        place = SE3(turn, middle - turn @ board.mean(axis=0))
        seen = [
            c.sees((truth.cam_from_rig[i] @ place).apply(board)).all() for i, c in enumerate(truth.cameras)
        ]
        if sum(seen) < 2:
            continue
        name = f"{len(held):03d}"
        for i, camera in enumerate(truth.cameras):
            if seen[i]:
                pixels = camera.project((truth.cam_from_rig[i] @ place).apply(board))
                noisy = pixels + options.noise * rng.normal(size=pixels.shape)
                sightings[i][name] = Corners(f"{NAMES[i]}: {name}", np.arange(len(board)), noisy)
        held.append(middle)
    known = [
        KnownCamera.exact(calibrate(list(one.values()), board, (c.width, c.height), Settings()).camera)
        for one, c in zip(sightings, truth.cameras, strict=True)
    ]
    rig = fit_rig(NAMES, known, sightings, board, refine=True).rig
    places = np.array(held)
    points = rng.uniform(places.min(axis=0), places.max(axis=0), (options.points, 3))
    error = rig_error(rig, truth, points, options.noise, seed=seed)
    return error.ratio**2, 1000 * error.rms_m, 1000 * error.foretold_m


def main() -> None:
    """Run and print."""
    options = asked()
    found, failed = [], []
    for seed in range(2 if options.quick else options.runs):
        try:
            found.append(one_run(seed, options))
        except VisionRobotError as error:
            failed.append(f"seed {seed}: {error}")
    each = np.array(found)
    again = np.random.default_rng(0).choice(each[:, 0], (4000, len(each))).mean(axis=1)
    low, high = (float(np.sqrt(q)) for q in np.percentile(again, [2.5, 97.5]))
    ratio = float(np.sqrt(each[:, 0].mean()))
    rms, foretold = (float(np.sqrt(np.mean(each[:, k] ** 2))) for k in (1, 2))
    rows = [[f"{rms:.4f}", f"{foretold:.4f}", f"{ratio:.3f}", f"[{low:.3f}, {high:.3f}]"]]
    table = markdown(("error, mm rms", "foretold, mm", "error / sigma", "95 % interval"), rows)
    table += (
        f"\n\n{len(found)} rigs of three cameras, {options.moments} moments, {options.noise} px, "
        f"{options.points} points each; {len(failed)} runs failed."
    )
    table += "".join(f"\n{line}" for line in failed)
    figures = {"error_mm": rms, "foretold_mm": foretold, "ratio": ratio, "low": low, "high": high}
    print(shown("vr.benchmark.triangulation/1", figures, table, as_json=options.json))


if __name__ == "__main__":
    main()
