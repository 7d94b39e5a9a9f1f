"""Corner sets of a board that is not flat."""

from dataclasses import replace

import numpy as np

from tests.views import Views
from vision_robot.calibrate import Corners


def bent(views: Views, *, by_m: float, seed: int = 0, noise_px: float = 0.2) -> Views:
    """The same views of a board bent by `by_m` from its lowest to its highest point, `board` as drawn."""
    x, y, _ = (views.board - views.board.mean(axis=0)).T
    bend = 0.04 * x**2 - 0.03 * x * y
    bend *= by_m / np.ptp(bend)
    real = views.board + np.stack([0 * x, 0 * x, bend], axis=-1)
    pixels = views.camera.project(views.cam_from_board.apply(real))
    pixels += noise_px * np.random.default_rng(seed).normal(size=pixels.shape)
    corners = [Corners(view.image, view.ids, seen) for view, seen in zip(views.corners, pixels, strict=True)]
    return replace(views, corners=corners)
