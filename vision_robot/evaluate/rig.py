"""A rig beside the truth: where its cameras stand, and where it sees points."""

from dataclasses import dataclass

import numpy as np

from vision_robot.geometry import CameraRig, rotation_log, triangulate
from vision_robot.types import Array, Float

__all__ = ["RigError", "rig_error"]


@dataclass(frozen=True)
class RigError:
    """Errors of the cameras' places, and of points triangulated from where the true rig sees them."""

    position_m: Float[Array, "k"]
    rotation: Float[Array, "k"]
    errors: Float[Array, "n 3"]
    covariance: Float[Array, "n 3 3"]

    @property
    def rms_m(self) -> float:
        """Root mean square distance of points from the truth."""
        return float(np.sqrt(np.mean(np.sum(self.errors**2, axis=1))))

    @property
    def foretold_m(self) -> float:
        """What the covariances say it should be."""
        return float(np.sqrt(np.mean(np.trace(self.covariance, axis1=1, axis2=2))))

    @property
    def ratio(self) -> float:
        """Error over foretold error, each point in its own units."""
        white = np.einsum("ni,nij,nj->n", self.errors, np.linalg.inv(self.covariance), self.errors)
        return float(np.sqrt(np.mean(white) / 3))


def rig_error(
    rig: CameraRig,
    truth: CameraRig,
    points: Float[Array, "n 3"],
    noise_px: float,
    *,
    seed: int = 0,
) -> RigError:
    """Compare; `points` lie in the true rig's frame, and are seen with fresh noise of `noise_px`."""
    rng = np.random.default_rng(seed)
    each = [camera.project(truth.cam_from_rig[i].apply(points)) for i, camera in enumerate(truth.cameras)]
    pixels = np.stack(each, axis=1)
    size = np.array([[camera.width, camera.height] for camera in truth.cameras])
    with np.errstate(invalid="ignore"):
        outside = ((pixels < -0.5) | (pixels > size - 0.5)).any(axis=2)
    pixels[outside] = np.nan
    found = triangulate(rig, pixels + noise_px * rng.normal(size=pixels.shape), noise_px)
    known = np.isfinite(found.points[:, 0])
    mine, true = rig.cam_from_rig.inverse(), truth.cam_from_rig.inverse()
    turn = rotation_log(mine.rotation @ np.swapaxes(true.rotation, 1, 2))
    return RigError(
        position_m=np.linalg.norm(mine.translation - true.translation, axis=1),
        rotation=np.linalg.norm(turn, axis=1),
        errors=(found.points - points)[known],
        covariance=found.covariance[known],
    )
