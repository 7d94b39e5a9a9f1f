"""Sub-pixel chessboard corners: the maximum-likelihood fit of a blurred saddle."""

from vision_robot.calibrate.saddle.fit import LOST_PX, REACH, Saddles, fit_grid, fit_saddles

__all__ = ["LOST_PX", "REACH", "Saddles", "fit_grid", "fit_saddles"]
