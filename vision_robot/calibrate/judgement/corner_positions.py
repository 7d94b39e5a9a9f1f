"""Where the corners of a calibration stand before the camera."""

import numpy as np

from vision_robot.calibrate.result import CalibrationResult
from vision_robot.types import Array, Float

__all__ = ["corners_in_cam"]


def corners_in_cam(result: CalibrationResult, *, every: int = 1) -> tuple[Float[Array, "_ 3"], ...]:
    """Corners of each view in the camera frame [m]: their predicted rays met with the board's plane.

    Every n-th corner of a view where `every` is n. Rows are NaN where the lens model has no
    ray. The board's warp, a tenth of a millimetre, is left out.
    """
    pairs = zip(result.corners, result.residuals, strict=True)
    predicted = [(view.pixels + residual)[::every] for view, residual in pairs]
    counts = [len(pixels) for pixels in predicted]
    # One call for all views: undoing the lens costs most where it is called often.
    rays = result.camera.unproject(np.concatenate(predicted))
    normal = np.repeat(result.cam_from_board.rotation[:, :, 2], counts, axis=0)
    origin = np.repeat(result.cam_from_board.translation, counts, axis=0)
    reach = np.sum(normal * origin, axis=1) / np.sum(normal * rays, axis=1)
    points = np.where(reach[:, None] > 0, reach[:, None] * rays, np.nan)
    return tuple(np.split(points, np.cumsum(counts)[:-1]))
