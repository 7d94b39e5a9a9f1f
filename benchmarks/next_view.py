"""How many views reach a given projection uncertainty: the next best view against random ones.

Both start from the same three views and add one at a time: the view that `next_views`
names for the present calibration, or one drawn from the same candidates. The corners of
the chosen pose are made with the true camera and fresh noise, and the camera is calibrated
anew. Counted are the views after which the stated projection uncertainty (rms over the
picture of the length of the error) is below each target; the true error beside it shows
that the statement holds.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from synthetic import board_points, seen, some_camera, some_views
from table import markdown, mean_interval, shown

from vision_robot.calibrate import CalibrationResult, Corners, Settings, calibrate
from vision_robot.calibrate.judgement.candidate_views import CandidateViews, candidate_views
from vision_robot.calibrate.judgement.next_view import next_views
from vision_robot.calibrate.judgement.picture import Picture
from vision_robot.errors import DegenerateViews, NoConvergence
from vision_robot.geometry import SE3, Camera

TARGETS_PX = (0.4, 0.3, 0.2, 0.15)
NOISE_PX = 0.2
START = 3

Choice = Callable[[CalibrationResult, CandidateViews, np.random.Generator], list[SE3]]


@dataclass(frozen=True)
class Run:
    """Stated sigma and true error [px] after START, START + 1, ... views."""

    sigma: list[float]
    error: list[float]


def best(result: CalibrationResult, candidates: CandidateViews, _: np.random.Generator) -> list[SE3]:
    """Poses in the order the library would take them."""
    poses = next_views(result, board_points(), count=8, candidates=candidates).cam_from_board
    return [poses[i] for i in range(len(poses))]


def chance(_: CalibrationResult, candidates: CandidateViews, rng: np.random.Generator) -> list[SE3]:
    """Any of the same poses."""
    return [candidates.cam_from_board[int(i)] for i in rng.permutation(len(candidates))]


def grown(camera: Camera, model: str, seed: int, choose: Choice, most: int) -> Run:
    """Calibrations of a growing set of views."""
    rng = np.random.default_rng([seed, 2])
    board, corners = board_points(), list(started(camera, model, seed))
    result = solved(camera, corners, model)
    truth = Picture.of(camera)
    run = Run([], [])
    while True:
        uncertainty = Picture.of(result.camera).weight() * result.covariance.intrinsics
        run.sigma.append(float(np.sqrt(np.sum(uncertainty))))
        run.error.append(float(np.sqrt(truth.mean_square(truth.difference(result.camera)))))
        if len(corners) >= most or run.sigma[-1] < min(TARGETS_PX):
            return run
        candidates = candidate_views(result.camera, board)
        poses = choose(result, candidates, rng) + chance(result, candidates, rng)
        # The present camera only believes that the board fits into the picture.
        pose = next(pose for pose in poses if camera.sees(pose.apply(board)).all())
        corners.append(seen(camera, pose, board, rng, NOISE_PX, f"view {len(corners)}"))
        result = solved(camera, corners, model)


def started(camera: Camera, model: str, seed: int) -> list[Corners]:
    """The first few views, the same for both ways; more than START where those determine nothing."""
    views = some_views(camera, START + 12, seed=seed, noise_px=NOISE_PX).corners
    for count in range(START, len(views)):
        try:
            solved(camera, views[:count], model)
        except (DegenerateViews, NoConvergence):
            continue
        return views[:count]
    return views


def solved(camera: Camera, corners: list[Corners], model: str) -> CalibrationResult:
    """The calibration."""
    return calibrate(corners, board_points(), (camera.width, camera.height), Settings(model=model))


def reached(run: Run, target: float, first: int, most: int) -> int:
    """Views needed for a target; `most` + 1 where they did not do."""
    below = np.flatnonzero(np.array(run.sigma) < target)
    return first + int(below[0]) if len(below) else most + 1


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--model", default="brown5")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--most", type=int, default=60, help="views after which a run is given up")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="two seeds, few views: only to see that it runs")
    options = parser.parse_args()
    seeds, most = (2, 6) if options.quick else (options.seeds, options.most)
    counts = np.zeros((2, seeds, len(TARGETS_PX)), dtype=int)
    honesty: list[float] = []
    for seed in range(seeds):
        camera = some_camera(np.random.default_rng([seed, 3]), options.model)
        first = len(started(camera, options.model, seed))
        for way, choose in enumerate((best, chance)):
            run = grown(camera, options.model, seed, choose, most)
            counts[way, seed] = [reached(run, target, first, most) for target in TARGETS_PX]
            honesty.append(run.error[-1] / run.sigma[-1])
    rows, figures = [], []
    for i, target in enumerate(TARGETS_PX):
        ours, random = counts[0, :, i], counts[1, :, i]
        given_up = [int((way > most).sum()) for way in (ours, random)]
        ratio = mean_interval(np.log(random / ours))
        figures.append(
            {
                "target_px": target,
                "next_best": mean_interval(ours),
                "random": mean_interval(random),
                "ratio": list(np.exp(ratio)),
                "given_up": given_up,
                "seeds": seeds,
            }
        )
        cells = [
            f"{'≥ ' * bool(lost)}{mean:.1f} [{low:.1f}, {high:.1f}]"
            for lost, (mean, low, high) in zip(
                given_up, (mean_interval(ours), mean_interval(random)), strict=True
            )
        ]
        rows.append([f"{target} px", *cells, "{:.2f} [{:.2f}, {:.2f}]".format(*np.exp(ratio))])
    columns = ("projection uncertainty below", "views, next best", "views, random", "random / next best")
    table = markdown(columns, rows)
    table += (
        f"\n\n{options.model}, {NOISE_PX} px, {seeds} seeds, means (ratio: geometric) and 95 % intervals; "
        f"≥: some runs given up after {most} views. "
        f"True over stated error at the end, rms: {np.sqrt(np.mean(np.square(honesty))):.2f}."
    )
    print(shown("vr.benchmark.next_view/1", figures, table, as_json=options.json))


if __name__ == "__main__":
    main()
