"""Whether the board is as large as it is said to be: the arm's lengths are the measure."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.arm_residuals import arm_rows
from vision_robot.calibrate.hand_eye.reduced import Reduced
from vision_robot.calibrate.hand_eye.result import HandEyeResult

__all__ = ["BoardScale", "board_scale"]

SURE = 4.0
"""Standard deviations: one in 16 000 by chance."""

LARGE = 1e-3
"""A tenth of a percent: less is the print's and the ruler's business."""


@dataclass(frozen=True)
class BoardScale:
    """The board's size over its stated size, in the arm's metres, with one standard deviation."""

    scale: float
    sigma: float

    @property
    def doubtful(self) -> bool:
        """Whether the stated size is contradicted."""
        return abs(self.scale - 1) > max(SURE * self.sigma, LARGE)


def board_scale(result: HandEyeResult) -> BoardScale:
    """One more unknown in the reduced problem: a board larger by a factor stands farther off by as much."""
    rows, old = arm_rows(result.state), result.reduced
    shift = result.cam_from_board.translation
    column = rows.in_pose[:, :, 3:] @ shift[..., None]
    s = old.design.shape[2]
    prior, gradient = np.zeros((s + 1, s + 1)), np.zeros(s + 1)
    prior[:s, :s], gradient[:s] = old.prior, old.prior_gradient
    design = np.concatenate([old.design, column], axis=2)
    solved = Reduced(old.residual, design, old.by_pictures, prior, gradient).weighed(result.noise.noise)
    return BoardScale(1 + float(solved.step[-1]), float(np.sqrt(solved.covariance[-1, -1])))
