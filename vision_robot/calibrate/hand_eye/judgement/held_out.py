"""Each view foretold by the others: where the arm says its corners are, against where they were seen.

The fit without a view is one Gauss-Newton step away: with S = V - H C H^T of the view,
``theta_without = theta + C H^T S^-1 e``, and what the others foretell of it errs with covariance
``V S^-1 V`` (Cook & Weisberg 1982, section 2.2, for blocks).
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.result import HandEyeResult
from vision_robot.calibrate.normal_equations import residuals
from vision_robot.calibrate.state import State
from vision_robot.types import Array, Float

__all__ = ["HeldOutViews", "hold_out_views"]


@dataclass(frozen=True)
class HeldOutViews:
    """Errors of each view, foretold by the others from the arm's pose alone.

    `rms_px` (views,) of its corners; `shift_m` and `turn` (views,) of the wrist; `foretold_*` one
    standard deviation, all axes together, that the others promise.
    """

    rms_px: Float[Array, "views"]
    at_board_m: Float[Array, "views"]
    """Root mean square distance of the board's points from where they were seen [m]."""
    shift_m: Float[Array, "views"]
    turn: Float[Array, "views"]
    foretold_shift_m: Float[Array, "views"]
    foretold_turn: Float[Array, "views"]

    @property
    def total_px(self) -> float:
        """Root mean square over all views, per corner [px]."""
        return float(np.sqrt(np.mean(self.rms_px**2)))

    @property
    def total_m(self) -> float:
        """The same at the board [m]."""
        return float(np.sqrt(np.mean(self.at_board_m**2)))

    @property
    def ratio(self) -> float:
        """Found over foretold, shifts and turns alike; one where the covariance is honest."""
        parts = (self.shift_m / self.foretold_shift_m, self.turn / self.foretold_turn)
        return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))


def hold_out_views(result: HandEyeResult) -> HeldOutViews:
    """Hold out each view in turn."""
    solved = result.reduced.weighed(result.noise.noise)
    H, C = solved.of.design, solved.covariance
    V = solved.of.by_pictures + np.diag(np.repeat(result.noise.noise.variances, 3))
    S_inverse = np.linalg.inv(V - H @ C @ np.swapaxes(H, 1, 2))
    pulled = (S_inverse @ solved.left[..., None])[..., 0]
    off = (V @ pulled[..., None])[..., 0]
    foretold = np.diagonal(V @ S_inverse @ V, axis1=1, axis2=2)
    steps = np.einsum("kl,vil,vi->vk", C, H, pulled)
    px, at_board = [], []
    for i, step in enumerate(steps):
        rms, distance = _foretold(result, i, step)
        px.append(rms)
        at_board.append(distance)
    return HeldOutViews(
        rms_px=np.array(px),
        at_board_m=np.array(at_board),
        shift_m=np.linalg.norm(off[:, 3:], axis=1),
        turn=np.linalg.norm(off[:, :3], axis=1),
        foretold_shift_m=np.sqrt(foretold[:, 3:].sum(axis=1)),
        foretold_turn=np.sqrt(foretold[:, :3].sum(axis=1)),
    )


def _foretold(result: HandEyeResult, view: int, step: Float[Array, "s"]) -> tuple[float, float]:
    """Rms of a view's corners [px], and of the board's points [m], at the unknowns without it."""
    one = np.array([view])
    state = result.state.keeping(one)
    moved = state.moved(result.problem.free, step, np.zeros((1, 6)))
    state = moved if moved is not None else state
    seen = result.problem.pictures.seen[one]
    said = state.predicted_cam_from_board
    off = residuals(State(state.pictures.camera, said, state.pictures.warp), seen)
    present = seen.present[0]
    points = seen.points[0].T[present]
    apart = said.apply(points)[0] - result.cam_from_board[one].apply(points)[0]
    rms = float(np.sqrt(np.mean(np.sum(off[0][:, present] ** 2, axis=0))))
    return rms, float(np.sqrt(np.mean(np.sum(apart**2, axis=1))))
