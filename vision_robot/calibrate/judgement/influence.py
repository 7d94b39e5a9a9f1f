"""What each view decides: the calibration without it, one Gauss-Newton step away.

Leaving out view v moves the minimum, to first order, by ``(H - S_v)^-1 g_v`` (the blocks of
`view_blocks`); under a right model with the covariance ``s^2 ((H - S_v)^-1 - H^-1)``. The
step d is told as what it does to the picture and as Cook's distance ``d^T H d / (p s^2)``
(Cook 1977): one, when leaving out the view moves the estimate about to the edge of its own
confidence region.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.judgement.picture import Picture
from vision_robot.calibrate.judgement.solution import solution
from vision_robot.calibrate.judgement.view_blocks import ViewBlocks
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.types import Array, Float

__all__ = ["Influence", "influence"]

DECISIVE = 1.0
"""Shift over the picture, in standard deviations of all views' answer, from which one decides too much."""

SURPRISING = 4.0
"""Shift, over what a right model predicts, from which a view contradicts the others."""


SEVERAL = 3
"""Contradicting views from which the fault is hardly one of single views."""


@dataclass(frozen=True)
class Influence:
    """A row for each view: how the calibration changes when it is left out.

    `moved_px` is the root mean square over the picture of where points at infinity go, a
    turn of the camera's frame taken out; `expected_px` what a right model predicts for it;
    `cook` Cook's distance; `change` (views, s) that of each shared parameter. Infinite, and
    NaN in `change`, where the other views cannot do without it. `sigma_px` is one standard
    deviation of the whole calibration, over the picture, to measure by.
    """

    images: tuple[str, ...]
    moved_px: Float[Array, "views"]
    expected_px: Float[Array, "views"]
    cook: Float[Array, "views"]
    change: Float[Array, "views s"]
    sigma_px: float

    @property
    def decisive(self) -> tuple[str, ...]:
        """Views that decide too much: without them the picture moves by more than its sigma."""
        return self._named(self.moved_px > DECISIVE * self.sigma_px)

    @property
    def contradicting(self) -> tuple[str, ...]:
        """Views that pull farther than noise explains: the model, the board or the view is wrong."""
        return self._named(self.moved_px > SURPRISING * self.expected_px)

    @property
    def sentences(self) -> tuple[str, ...]:
        """What the table says, in words."""
        said = []
        for i in np.argsort(-self.moved_px):
            image, moved = self.images[i], self.moved_px[i]
            if np.isinf(moved):
                said.append(
                    f"without {image} the other views leave something undetermined: add views like it"
                )
            elif image in self.decisive:
                said.append(
                    f"{image} decides much alone: without it the picture moves by {moved:.2g} px "
                    f"(sigma {self.sigma_px:.2g} px): add views like it"
                )
            if image in self.contradicting and np.isfinite(moved):
                said.append(
                    f"{image} contradicts the other views: it pulls {moved / self.expected_px[i]:.1f} times "
                    "as far as noise explains"
                )
        if len(self.contradicting) >= SEVERAL:
            said.append(
                f"{len(self.contradicting)} views contradict the others: do all pictures come from "
                "one camera, at one focus and zoom?"
            )
        return tuple(said) or ("no single view decides much",)

    def _named(self, which: Array) -> tuple[str, ...]:
        return tuple(self.images[i] for i in np.flatnonzero(which))


def influence(result: CalibrationResult, board_points: Float[Array, "m 3"]) -> Influence:
    """Leave out each view in turn, without a refit; `board_points` (m, 3) [m] as given to `calibrate`."""
    blocks = ViewBlocks.of(*solution(result, board_points))
    others = 1 - np.eye(blocks.views)
    steps, spread = blocks.steps(others), blocks.spread(others)
    change = blocks.parameters(steps)
    M = Picture.of(result.camera).weight()
    p = len(M)
    in_camera = blocks.parameters(np.eye(steps.shape[1]))[:, :p].T
    M_steps = in_camera.T @ M @ in_camera
    moved = np.sqrt(np.maximum(np.einsum("vp,pq,vq->v", change[:, :p], M, change[:, :p]), 0))
    expected = np.sqrt(np.maximum(np.einsum("kl,vkl->v", M_steps, spread), 0))
    lost = ~np.isfinite(moved)
    cook = np.sum(steps**2, axis=1) / (steps.shape[1] * blocks.variance)
    return Influence(
        images=tuple(view.image for view in result.corners),
        moved_px=np.where(lost, np.inf, moved),
        expected_px=np.where(lost, np.inf, expected),
        cook=np.where(lost, np.inf, cook),
        change=change,
        sigma_px=float(np.sqrt(blocks.variance * np.trace(M_steps))),
    )
