"""The next best view: where to hold the board so that the camera is known best afterwards.

A view v adds to the information on the shared parameters its own Schur complement
``S_v = B - W V^-1 W^T``, whatever its noise turns out to be, so the gain of a view not yet
taken can be computed: at the present camera, with the present noise, the covariance would
fall from ``S^-1`` to ``(S + S_v)^-1``. What counts is not a parameter but where points are
seen: the mean square projection error over the picture, ``tr(M C)`` (`Picture`). This
is A-optimal design on the projection, with the implied rotation taken out (as a criterion
over parameters: Peng & Sturm 2019, "Calibration wizard"; over projection: this).
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.judgement.candidate_views import CandidateViews, candidate_views
from vision_robot.calibrate.judgement.information import view_information
from vision_robot.calibrate.judgement.picture import Picture
from vision_robot.calibrate.judgement.solution import solution
from vision_robot.calibrate.normal_equations import normal_equations
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.refine import schur_complement
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.calibrate.state import State
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot.types import Array, Bool, Float

__all__ = ["NextViews", "next_views"]

VAGUE_LENS, VAGUE_BOARD_M = 1e3, 0.1
"""One sigma of what is believed of a coefficient or warp before any view: next to nothing."""


@dataclass(frozen=True)
class NextViews:
    """The views that help most, best first, each the best beside all those before it.

    Sigmas are of the projection error over the picture, root mean square of its length
    [px]: `sigma_px` as it is, `alone_px` (k,) with this one view more, `together_px` (k,)
    with this one and all before it. `words` say how to hold the board.
    """

    views: CandidateViews
    words: tuple[str, ...]
    sigma_px: float
    alone_px: Float[Array, "k"]
    together_px: Float[Array, "k"]

    @property
    def cam_from_board(self) -> SE3:
        """Poses of the board."""
        return self.views.cam_from_board

    def __len__(self) -> int:
        return len(self.words)


def next_views(
    result: CalibrationResult,
    board_points: Float[Array, "m 3"],
    *,
    count: int = 5,
    whole: bool = True,
    candidates: CandidateViews | None = None,
) -> NextViews:
    """The `count` next views that lower the projection uncertainty most.

    Args:
        result: The calibration so far.
        board_points: Points (m, 3) of its board [m].
        count: How many views, different from each other in place or tilt; fewer where the picture
            has no room.
        whole: Whether the whole board must be seen; False for targets with coded points.
        candidates: The views to choose from, `candidate_views` of the present camera where left out.

    Raises:
        BadParameter: `count` is not positive, or no view of the board fits into the picture.
    """
    if count < 1:
        raise BadParameter("number of next views", count, "positive")
    if candidates is None:
        candidates = candidate_views(result.camera, board_points, whole=whole)
    if not len(candidates):
        raise BadParameter("board", f"{len(board_points)} points", "one that fits into the picture")
    state, problem = solution(result, board_points)
    equations, free = normal_equations(state, problem), problem.free
    variance = 2 * equations.cost / max(problem.degrees_of_freedom, 1)
    present = schur_complement(equations) / variance
    present += np.diag(1 / _vague(state)[free] ** 2)
    added = _added(result, board_points, candidates, free) / variance
    weight = np.zeros((len(free), len(free)))
    p = len(result.camera.parameters)
    weight[:p, :p] = Picture.of(result.camera).weight()
    weight = weight[np.ix_(free, free)]

    before = float(_sigma(present, weight))
    first = _sigma(present + added, weight)
    chosen: list[int] = []
    together: list[float] = []
    open_to_choice = np.ones(len(candidates), dtype=bool)
    while len(chosen) < count and open_to_choice.any():
        after = _sigma(present + added, weight) if chosen else first
        best = int(np.argmin(np.where(open_to_choice, after, np.inf)))
        chosen.append(best)
        together.append(float(after[best]))
        present = present + added[best]
        alike = (candidates.cell == candidates.cell[best]) & (candidates.away == candidates.away[best])
        open_to_choice &= ~alike
    index = np.array(chosen)
    return NextViews(
        views=candidates[index],
        words=tuple(candidates.words(i) for i in chosen),
        sigma_px=before,
        alone_px=first[index],
        together_px=np.array(together),
    )


def _added(
    result: CalibrationResult, board_points: Array, candidates: CandidateViews, free: Bool[Array, "s"]
) -> Float[Array, "k f f"]:
    """Information of each candidate in units of the corners' weights, with corners as sure as now."""
    sigma = np.median(np.concatenate([view.sigma_px for view in result.corners]))
    corners = [
        Corners(f"candidate {i}", np.flatnonzero(seen), pixels[seen], np.full(seen.sum(), sigma))
        for i, (pixels, seen) in enumerate(zip(candidates.pixels, candidates.seen, strict=True))
    ]
    state = State(result.camera, candidates.cam_from_board, result.warp)
    return view_information(state, Observations.of(corners, board_points), free)[0]


def _vague(state: State) -> Float[Array, "s"]:
    """Standard deviations that stand for no knowledge but keep undetermined directions finite."""
    camera = state.camera
    affine = [camera.fx, camera.fy, camera.width, camera.height, camera.fx]
    lens, board = len(camera.distortion), len(state.warp)
    return np.concatenate([10 * np.array(affine), np.full(lens, VAGUE_LENS), np.full(board, VAGUE_BOARD_M)])


def _sigma(information: Float[Array, "*k f f"], weight: Float[Array, "f f"]) -> Float[Array, "*k"]:
    """Root mean square projection error [px] under the inverse of each information."""
    scale = 1 / np.sqrt(np.diagonal(information, axis1=-2, axis2=-1))
    scaled = information * scale[..., :, None] * scale[..., None, :]
    covariance = np.linalg.inv(scaled) * scale[..., :, None] * scale[..., None, :]
    return np.sqrt(np.maximum(np.einsum("ij,...ij->...", weight, covariance), 0))
