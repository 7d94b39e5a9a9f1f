"""Where the joint descent starts: a closed form on views that agree with each other."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.closed_forms import park_martin, shah
from vision_robot.geometry import SE3
from vision_robot.types import Array, Bool, Float

__all__ = ["Fit", "closed_fit", "consistent_fit", "disagreement"]

SUBSET = 5
SUBSETS = 150
"""With 40 % of all views wrong a clean subset of five is among these with 99.9999 %."""

OUT_OF_LINE = 6.0
"""Times the typical disagreement from which a view does not belong to the rest."""

MEDIAN_TO_SIGMA = 1 / 1.8
"""Median length of a three-dimensional Gaussian vector is 1.54 sigma; two such parts together 1.8."""


@dataclass(frozen=True)
class Fit:
    """A closed form and how the views agree with it; `size` (n,) is turn and shift/reach together."""

    mount_from_cam: SE3
    far_from_board: SE3
    turn: Float[Array, "n"]
    shift_m: Float[Array, "n"]
    size: Float[Array, "n"]
    agree: Bool[Array, "n"]

    @property
    def typical(self) -> float:
        """Median disagreement, turn [rad] and shift as a part of the board's distance together."""
        return float(np.median(self.size))


def closed_fit(mount_from_far: SE3, cam_from_board: SE3) -> Fit:
    """Fit all views; of two closed forms the one that leaves less."""
    fits = [
        _fit(solve(mount_from_far, cam_from_board), mount_from_far, cam_from_board)
        for solve in (shah.solve, park_martin.solve)
    ]
    return min(fits, key=lambda fit: fit.typical)


def consistent_fit(mount_from_far: SE3, cam_from_board: SE3, *, seed: int = 0) -> Fit:
    """Fit the largest part of the views that agree, by least median of squares over small subsets."""
    n = len(cam_from_board)
    best = closed_fit(mount_from_far, cam_from_board)
    if best.agree.all() or n < SUBSET + 2:
        return best
    rng = np.random.default_rng(seed)
    for _ in range(SUBSETS):
        some = rng.choice(n, SUBSET, replace=False)
        solved = shah.solve(mount_from_far[some], cam_from_board[some])
        fit = _fit(solved, mount_from_far, cam_from_board)
        if fit.typical < best.typical:
            best = fit
    for _ in range(5):
        some = best.agree
        if some.sum() < SUBSET:
            break
        solved = shah.solve(mount_from_far[some], cam_from_board[some])
        again = _fit(solved, mount_from_far, cam_from_board)
        if again.typical >= best.typical and again.agree.sum() <= some.sum():
            break
        best = again
    return best


def disagreement(
    mount_from_cam: SE3, far_from_board: SE3, mount_from_far: SE3, cam_from_board: SE3
) -> tuple[Float[Array, "*n"], Float[Array, "*n"]]:
    """Turn [rad] and shift [m] between where the arm says the board is and where it was seen."""
    said = mount_from_cam.inverse() @ mount_from_far @ far_from_board
    turn = SE3(said.rotation @ np.swapaxes(cam_from_board.rotation, -1, -2), said.translation).rotvec()
    shift = said.translation - cam_from_board.translation
    return np.linalg.norm(turn, axis=-1), np.linalg.norm(shift, axis=-1)


def _fit(solved: tuple[SE3, SE3], mount_from_far: SE3, cam_from_board: SE3) -> Fit:
    turn, shift = disagreement(*solved, mount_from_far, cam_from_board)
    reach = float(np.median(np.linalg.norm(cam_from_board.translation, axis=-1)))
    size = np.hypot(turn, shift / reach)
    agree: Array = size <= OUT_OF_LINE * max(float(np.median(size)) * MEDIAN_TO_SIGMA, 1e-9)
    return Fit(*solved, turn, shift, size, agree)
