"""How near the truth a hand-eye calibration comes, whether its intervals hold it, and how fast it is.

`accuracy`: median error over trials of 15 poses, 88 corners with 0.2 px of noise, an arm with 0.3 mm and
0.02 degrees of noise per axis: two arms, both set-ups, and an arm that can take any pose. Beside closed forms
(with --opencv4-python OpenCV 4's own), and the joint refinement with the arm taken as exact.
`rendered`: the same from rendered pictures.
`coverage`: how often the 95 % intervals of all twelve numbers hold the truth.
`geometry`: an arm whose links are off by 1 mm and 0.3 degrees: where the camera is at poses not used.
`next`: views to a wanted sigma, next best against drawn. `speed`: one calibration from corners.
"""

import argparse
from collections.abc import Callable
from time import perf_counter

import numpy as np
from hand_eye_opencv4 import run_opencv4
from hand_eye_trials import BOARD, CELLS, NOISE_PX, Trial, trial
from table import markdown, shown

from vision_robot.calibrate.detect import detect_boards
from vision_robot.calibrate.hand_eye import (
    ArmNoise,
    GeometryTolerance,
    HandEyeResult,
    HandEyeSettings,
    calibrate_hand_eye,
)
from vision_robot.calibrate.hand_eye.judgement.next_pose import next_poses
from vision_robot.calibrate.hand_eye.setup import setup_named
from vision_robot.errors import NoConvergence
from vision_robot.evaluate.hand_eye import hand_eye_error, place_errors
from vision_robot.geometry import SE3, HandEye
from vision_robot.types import Array, Float
from vision_robot_synth.hand_eye import HandEyeSet, hand_eye_set

NOTHING = np.zeros((12, 12))
EXACT = ArmNoise(1e-6, 1e-6)
LINKS = (float(np.radians(0.3)), 1e-3)
REPEATS = ArmNoise(float(np.radians(0.002)), 0.02e-3)
"""Of an arm that repeats well but is built otherwise than drawn."""


def asked() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("parts", nargs="*", help=", ".join(PARTS), default=list(PARTS))
    parser.add_argument("--trials", type=int, default=30)
    parser.add_argument("--coverage-trials", type=int, default=300)
    parser.add_argument("--views", type=int, default=15)
    parser.add_argument("--opencv4-python", help="a Python with opencv-python 4, to run its solvers beside")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="two trials: only to see that it runs")
    return parser.parse_args()


def solve(one: Trial, noise: ArmNoise | None = None) -> HandEyeResult:
    """Calibrate; with a noise given, that of the arm is not estimated and nothing is left out."""
    settings = HandEyeSettings(one.setup, noise=noise, robust=noise is None)
    return calibrate_hand_eye(one.corners, one.said, one.board, one.camera, settings)


def accuracy(options: argparse.Namespace) -> tuple[str, list[dict]]:
    """Median errors of every method in every cell."""
    table: dict[tuple[str, str], dict[str, tuple[float, float]]] = {}
    for cell in CELLS:
        trials = [trial(*cell, options.views, seed) for seed in range(options.trials)]
        results = [solve(one) for one in trials]
        found: dict[str, list[SE3]] = {"ours": [result.mount_from_cam for result in results]}
        for name in results[0].closed_forms:
            found[name] = [result.closed_forms[name][0] for result in results]
        found["joint, arm exact"] = [_exact(one) for one in trials]
        if options.opencv4_python:
            found |= _opencv4(options.opencv4_python, trials)
        table[cell] = {}
        for name, mounts in found.items():
            errors = [one.error(mount) for one, mount in zip(trials, mounts, strict=True)]
            shift, turn = np.median(errors, axis=0)
            table[cell][name] = float(1e3 * shift), float(np.degrees(turn))
    names = list(table[CELLS[0]])
    rows = [[n, *(f"{table[c][n][0]:.3f} mm, {table[c][n][1]:.4f}°" for c in CELLS)] for n in names]
    figures = [{"cell": c, "method": n, "mm": mm, "deg": d} for c in CELLS for n, (mm, d) in table[c].items()]
    return markdown(("median error", *map(", ".join, CELLS)), rows), figures


def _exact(one: Trial) -> SE3:
    try:
        return solve(one, EXACT).mount_from_cam
    except NoConvergence:
        return SE3(np.eye(3), np.full(3, np.inf))  # counts as an error above every median


def _opencv4(python: str, trials: list[Trial]) -> dict[str, list[SE3]]:
    setup = setup_named(trials[0].setup)
    arm = np.array([setup.mount_from_far(one.said).inverse().as_matrix() for one in trials])
    from vision_robot.calibrate.hand_eye.board_poses import find_board_poses

    seen = np.array(
        [find_board_poses(t.corners, t.board, t.camera)[0].cam_from_board.as_matrix() for t in trials]
    )
    return {
        name: [SE3.from_matrix(pose) for pose in poses]
        for name, poses in run_opencv4(python, arm, seen).items()
    }


def coverage(options: argparse.Namespace) -> tuple[str, list[dict]]:
    """Share of 95 % intervals that hold the truth, with the standard error over trials."""
    rows, figures = [], []
    for cell in CELLS:
        held, scaled = [], []
        for seed in range(options.coverage_trials):
            one = trial(*cell, options.views, 10_000 + seed)
            result = solve(one)
            error = hand_eye_error(result.hand_eye, one.truth)
            held.append(np.abs(error.step) <= result.covariance.half_width)
            scaled.append(error.in_sigma)
        share, each = 100 * float(np.mean(held)), 100 * np.mean(held, axis=0)
        scatter = 100 * float(np.std(np.mean(held, axis=1))) / np.sqrt(len(held))
        spread = float(np.sqrt(np.mean(np.square(scaled))))
        told = (f"{share:.1f} ± {scatter:.1f} %", f"{each.min():.1f} to {each.max():.1f} %", f"{spread:.3f}")
        rows.append([", ".join(cell), len(held), *told])
        figures.append({"cell": cell, "share": share, "each": each.tolist(), "spread": spread})
    columns = ("cell", "trials", "held the truth", "each of the twelve", "spread")
    return markdown(columns, rows), figures


def rendered(options: argparse.Namespace) -> tuple[str, list[dict]]:
    """The same from pictures rendered at the column arm's poses and searched for the board."""
    rows, figures = [], []
    for setup in ("eye-in-hand", "eye-to-hand"):
        errors: dict[str, list[float]] = {}
        held = []
        for seed in range(options.trials):
            made = hand_eye_set(setup, views=options.views, board=BOARD, seed=seed)
            found = detect_boards(dict(zip(made.names, made.images(), strict=True)), BOARD)
            kept = [i for i, view in enumerate(found) if view is not None]
            corners = [view for view in found if view is not None]
            result = calibrate_hand_eye(
                corners, made.said[kept], BOARD.points, made.camera, HandEyeSettings(setup)
            )
            cell = made.cell
            truth = HandEye(setup, made.camera, cell.mount_from_cam, cell.far_from_board, NOTHING)
            error = hand_eye_error(result.hand_eye, truth)
            held.append(np.abs(error.step) <= result.covariance.half_width)
            mounts = {"ours": result.mount_from_cam}
            mounts |= {name: mount for name, (mount, _) in result.closed_forms.items()}
            for name, mount in mounts.items():
                off = mount.translation - cell.mount_from_cam.translation
                errors.setdefault(name, []).append(1e3 * float(np.linalg.norm(off)))
        medians = {name: float(np.median(values)) for name, values in errors.items()}
        share = 100 * float(np.mean(held))
        rows.append([setup, *(f"{value:.3f} mm" for value in medians.values()), f"{share:.1f} %"])
        figures.append({"setup": setup, "mm": medians, "held": share})
    columns = ("column arm, rendered", *figures[0]["mm"], "held the truth")
    return markdown(columns, rows), figures


def geometry(options: argparse.Namespace) -> tuple[str, list[dict]]:
    """Where the camera is at poses not used, median over them and over trials."""
    errors: dict[str, list[float]] = {}
    seconds = []
    for seed in range(min(options.trials, 10)):
        made, fresh = (
            hand_eye_set(arm="six-axis", views=20, board=BOARD, noise=REPEATS, link_errors=LINKS, seed=s)
            for s in (seed, seed + 500)
        )
        truth = HandEye(
            "eye-in-hand", made.camera, made.cell.mount_from_cam, made.cell.far_from_board, NOTHING
        )
        for name, tolerance in (("links as drawn", None), ("links estimated", GeometryTolerance())):
            start = perf_counter()
            result = calibrate_hand_eye(
                made.corners(NOISE_PX),
                made.said,
                BOARD.points,
                made.camera,
                HandEyeSettings(geometry=tolerance),
                arm=made.cell.arm,
                joints=made.joints,
            )
            seconds += [perf_counter() - start] if tolerance else []
            arm = result.geometry.chain if result.geometry else made.cell.arm
            ends = {f"joint, {name}": (result.mount_from_cam, result.far_from_board)}
            if tolerance is None:
                ends["park-martin"] = result.closed_forms["park-martin"]
            for method, (mount, far) in ends.items():
                found = HandEye("eye-in-hand", made.camera, mount, far, NOTHING)
                off = place_errors(found, arm, truth, made.true_arm, fresh.joints)
                errors.setdefault(method, []).append(1e3 * float(np.median(off)))
    rows = [[name, f"{np.median(values):.3f} mm"] for name, values in errors.items()]
    text = markdown(("camera's place at 20 other poses", "median error"), rows)
    text += f"\n\n20 views, links off by 1 mm and 0.3°; {np.median(seconds):.2f} s a calibration with links."
    return text, [{"method": name, "mm": float(np.median(values))} for name, values in errors.items()]


def next_best(options: argparse.Namespace) -> tuple[str, list[dict]]:
    """Views until the camera's position is known to a wanted sigma, from the same four first."""
    wanted, most = 0.2e-3, 40
    counts: dict[str, list[int]] = {"next best": [], "drawn": []}

    def best(made: HandEyeSet, result: HandEyeResult) -> Float[Array, "n"]:
        joints = next_poses(result, arm=made.cell.arm, count=1).joints
        assert joints is not None
        return joints[0]

    for seed in range(min(options.trials, 12)):
        first = hand_eye_set(views=4, board=BOARD, seed=seed)
        drawn = hand_eye_set(views=most, board=BOARD, seed=seed).joints
        counts["next best"].append(_until(first, wanted, most, best))
        counts["drawn"].append(_until(first, wanted, most, lambda made, _, drawn=drawn: drawn[len(made)]))
    rows = [[name, f"{np.mean(values):.1f}"] for name, values in counts.items()]
    text = markdown((f"views to a position sigma of {1e3 * wanted:g} mm", "mean"), rows)
    return text, [{"method": name, "views": values} for name, values in counts.items()]


def _until(
    made: HandEyeSet,
    wanted: float,
    most: int,
    choose: Callable[[HandEyeSet, HandEyeResult], Float[Array, "n"]],
) -> int:
    while True:
        result = calibrate_hand_eye(made.corners(NOISE_PX), made.said, BOARD.points, made.camera)
        if result.covariance.position_m <= wanted or len(made) >= most:
            return len(made)
        made = made.driven_to(choose(made, result))


def speed(options: argparse.Namespace) -> tuple[str, list[dict]]:
    """Seconds of one calibration from corners, everything included."""
    rows, figures = [], []
    for views in (15, 50, 150):
        one = trial("any pose", "eye-in-hand", views, 0)
        taken = []
        for _ in range(2 if options.quick else 7):
            start = perf_counter()
            solve(one)
            taken.append(perf_counter() - start)
        rows.append([views, f"{np.median(taken):.3f}"])
        figures.append({"views": views, "seconds": float(np.median(taken))})
    return markdown(("views of 88 corners", "seconds"), rows), figures


PARTS = {
    "accuracy": accuracy,
    "rendered": rendered,
    "coverage": coverage,
    "geometry": geometry,
    "next": next_best,
    "speed": speed,
}


def main() -> None:
    """Run and print."""
    options = asked()
    if options.quick:
        options.trials = options.coverage_trials = 2
    tables, figures = [], {}
    for name in options.parts:
        text, figures[name] = PARTS[name](options)
        tables.append(f"### {name}\n\n{text}")
    print(shown("vr.benchmark.hand_eye/1", figures, "\n\n".join(tables), as_json=options.json))


if __name__ == "__main__":
    main()
