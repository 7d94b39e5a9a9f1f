"""Does `vr measure`'s sigma foretell its error? The whole chain, many times over: calibrate, plane, measure.

Each run draws a camera, calibrates it from noisy corners of boards held before it, finds the work plane from
one noisy view of the board lying on a table (with `--places` more where it was moved), and measures points of
the table, anywhere in the picture, from noisy pixels. `ratio` is the rms of error / sigma over all points and
both axes: 1 where sigma is honest; the target is 0.9 to 1.1. Beside it what the same numbers would say had
the camera been taken as exact, or camera and pose as independent of each other.
"""

import argparse

import numpy as np
from synthetic import board_points, seen, some_camera, some_views
from table import markdown, shown

from vision_robot.calibrate import Settings, calibrate
from vision_robot.errors import VisionRobotError
from vision_robot.extrinsics.plane import fit_plane
from vision_robot.geometry import SE3, Camera, KnownCamera, WorkPlane
from vision_robot.types import Array, Float


def asked() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--model", default="brown5")
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--points", type=int, default=10, help="measured in each run")
    parser.add_argument("--views", type=int, default=15, help="of the calibration")
    parser.add_argument("--places", type=int, default=0, help="photos more, the board elsewhere on the table")
    parser.add_argument("--noise", type=float, default=0.2, help="one sigma of a corner per axis [px]")
    parser.add_argument(
        "--pixel", type=float, default=0.2, help="one sigma of a measured pixel per axis [px]"
    )
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="three runs: only to see that it runs")
    return parser.parse_args()


def looking_down(camera: Camera, rng: np.random.Generator) -> SE3:
    """cam_from_station of a camera at 35 to 75 degrees over the table."""
    elevation, azimuth = np.radians(rng.uniform(35, 75)), rng.uniform(0, 2 * np.pi)
    distance = rng.uniform(1.6, 2.6) * float(np.ptp(board_points()[:, 0])) * camera.fx / camera.width
    back = np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )
    right = np.cross(-back, [0, 0, 1.0])
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(-back, right), -back])
    return SE3(rotation, -rotation @ (distance * back))


def lying(camera: Camera, pose: SE3, rng: np.random.Generator, *, middle: bool) -> SE3:
    """station_from_board of a board wholly in the picture; the first at the middle, others anywhere."""
    board = board_points()
    size = float(np.ptp(board[:, 0]))
    for attempt in range(500):
        reach = (0.0 if middle and not attempt else 1.0) * size
        yaw, shift = rng.uniform(-np.pi, np.pi), rng.uniform(-reach, reach, 2)
        turn = SE3.from_rotvec(np.array([0, 0, yaw]), np.zeros(3)).rotation @ np.diag([1.0, -1.0, -1.0])
        place = SE3(turn, np.array([*shift, 0.0]) - turn @ board.mean(axis=0))
        if camera.sees((pose @ place).apply(board)).all():
            return place
    raise ValueError("no place on the table is seen whole")


def one_run(seed: int, options: argparse.Namespace) -> dict[str, Float[Array, "n 2"]]:
    """Errors over sigma of each point: as stated, without the camera's error, without cross terms."""
    rng = np.random.default_rng([seed, 6])
    camera = some_camera(np.random.default_rng([seed, 4]), options.model)
    made = some_views(camera, options.views, seed=seed, noise_px=options.noise)
    result = calibrate(made.corners, made.board, made.size, Settings(model=options.model))
    known = KnownCamera(result.camera, result.covariance.intrinsics)
    pose = looking_down(camera, rng)
    places = [lying(camera, pose, rng, middle=i == 0) for i in range(1 + options.places)]
    views = [
        seen(camera, pose @ place, made.board, rng, options.noise, f"table {i}")
        for i, place in enumerate(places)
    ]
    plane = fit_plane(known, views, made.board, places[0]).plane
    size = np.array([camera.width, camera.height]) - 1.0
    pixels = rng.uniform(0, 1, (8 * options.points, 2)) * size
    truth, _ = WorkPlane.exact(camera, pose).measure(pixels)
    noisy = pixels + options.pixel * rng.normal(size=pixels.shape)
    positions, covariance = plane.measure(noisy, options.pixel)
    usable = np.flatnonzero(np.isfinite(truth[:, 0]) & np.isfinite(positions[:, 0]))[: options.points]
    error = (positions - truth)[usable]
    p = len(known.covariance)
    exact, apart = plane.covariance.copy(), plane.covariance.copy()
    own = fit_plane(KnownCamera.exact(known.camera), views, made.board, places[0]).plane.covariance
    exact[:] = own
    apart[:p, p:] = apart[p:, :p] = 0
    found = {"stated": covariance}
    for name, other in (("camera taken as exact", exact), ("no cross terms", apart)):
        found[name] = WorkPlane(plane.camera, plane.cam_from_station, other).measure(noisy, options.pixel)[1]
    spread = {
        name: error / np.sqrt(np.diagonal(one[usable], axis1=1, axis2=2)) for name, one in found.items()
    }
    return {**spread, "error_mm": 1000 * error}


def main() -> None:
    """Run and print."""
    options = asked()
    runs, failed = [], []
    for seed in range(3 if options.quick else options.runs):
        try:
            runs.append(one_run(seed, options))
        except VisionRobotError as error:
            failed.append(f"seed {seed}: {error}")
    rows, figures = [], []
    rms = float(np.sqrt(np.mean(np.concatenate([run["error_mm"] for run in runs]) ** 2)))
    for name in ("stated", "no cross terms", "camera taken as exact"):
        each = np.array([np.mean(run[name] ** 2) for run in runs])
        ratio = float(np.sqrt(each.mean()))
        # Points of one run share its errors: the runs are what is drawn anew.
        again = np.random.default_rng(0).choice(each, (4000, len(each))).mean(axis=1)
        low, high = (float(np.sqrt(q)) for q in np.percentile(again, [2.5, 97.5]))
        within = float(np.mean(np.abs(np.concatenate([run[name] for run in runs])) <= 1.96))
        rows.append([name, f"{ratio:.3f}", f"[{low:.3f}, {high:.3f}]", f"{100 * within:.1f} %"])
        figures.append({"sigma": name, "ratio": ratio, "low": low, "high": high, "within_95": within})
    count = sum(len(run["error_mm"]) for run in runs)
    table = markdown(("sigma", "error / sigma", "95 % interval", "inside 95 %"), rows)
    table += (
        f"\n\n{options.model}, {len(runs)} runs, {count} points, {options.views} views at "
        f"{options.noise} px, "
        f"{1 + options.places} photo(s) of the table, pixels at {options.pixel} px; error {rms:.4f} "
        f"mm rms per axis; "
        f"{len(failed)} runs failed."
    )
    table += "".join(f"\n{line}" for line in failed)
    figures.append({"points": count, "error_mm": rms, "failed": len(failed)})
    print(shown("vr.benchmark.measure/1", figures, table, as_json=options.json))


if __name__ == "__main__":
    main()
