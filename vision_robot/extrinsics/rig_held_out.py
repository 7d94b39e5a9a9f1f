"""Boards that the rig was not fitted to, triangulated and laid over their drawing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.extrinsics.rig import RigFit, fit_rig
from vision_robot.geometry import CameraRig, KnownCamera, triangulate
from vision_robot.types import Array, Float

__all__ = ["BoardError", "held_out_boards", "triangulated_board"]

EVERY = 4
"""One moment in so many is left out."""
FEWEST_MOMENTS = 8


@dataclass(frozen=True)
class BoardError:
    """Errors [m] of triangulated board points after laying the board over them, and their covariance.

    The covariance holds what points share too, which is laid away with the board: it is an upper bound.
    """

    errors: Float[Array, "n 3"]
    covariance: Float[Array, "n 3 3"]
    moments: int

    @property
    def rms_m(self) -> float:
        """Root mean square distance."""
        return float(np.sqrt(np.mean(np.sum(self.errors**2, axis=1))))

    @property
    def foretold_m(self) -> float:
        """What the covariances say, at most."""
        return float(np.sqrt(np.mean(np.trace(self.covariance, axis1=1, axis2=2))))


def held_out_boards(
    names: Sequence[str],
    cameras: Sequence[KnownCamera],
    sightings: Sequence[Mapping[str, Corners]],
    board_points: Float[Array, "m 3"],
    fit: RigFit,
) -> BoardError | None:
    """Fit again without one shared moment in four, and measure the board there; None with too few moments."""
    shared = [m for m in fit.moments if sum(m in seen for seen in sightings) >= 2]
    if len(shared) < FEWEST_MOMENTS:
        return None
    out = set(shared[EVERY // 2 :: EVERY])
    rest = [{m: view for m, view in seen.items() if m not in out} for seen in sightings]
    again = fit_rig(names, cameras, rest, board_points, refine=fit.refined, warp=fit.warp_degree)
    points = board_points + (fit.warp.displacement if len(fit.warp) else 0.0)
    dropped = {one.image for one in fit.rejected if one.corner is None}
    errors, covariance = [], []
    for moment in sorted(out):
        seen = {
            i: one[moment]
            for i, one in enumerate(sightings)
            if moment in one and f"{names[i]}: {moment}" not in dropped
        }
        if len(seen) < 2:
            continue
        off, spread = triangulated_board(again.rig, seen, points, again.noise_px)
        errors.append(off)
        covariance.append(spread)
    if not errors:
        return None
    return BoardError(np.concatenate(errors), np.concatenate(covariance), len(errors))


def triangulated_board(
    rig: CameraRig, seen: Mapping[int, Corners], board_points: Float[Array, "m 3"], noise_px: float
) -> tuple[Float[Array, "n 3"], Float[Array, "n 3 3"]]:
    """Triangulated points less the board laid over them (Umeyama 1991), and the points' covariance."""
    pixels = np.full((len(board_points), len(rig), 2), np.nan)
    for i, view in seen.items():
        pixels[view.ids, i] = view.pixels
    found = triangulate(rig, pixels, max(noise_px, 1e-9))
    known = np.isfinite(found.points[:, 0])
    points, board = found.points[known], board_points[known]
    a, b = points - points.mean(axis=0), board - board.mean(axis=0)
    U, _, Vt = np.linalg.svd(a.T @ b)
    rotation = U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt
    return a - b @ rotation.T, found.covariance[known]
