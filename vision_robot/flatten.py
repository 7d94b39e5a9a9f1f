"""Pictures without distortion: resampled by the exact map of the lens."""

from dataclasses import dataclass, field

import cv2
import numpy as np

from vision_robot.errors import MixedImageSizes
from vision_robot.geometry import Camera, resampling_map
from vision_robot.types import Array, Float, Image

__all__ = ["Flattener"]


@dataclass(frozen=True)
class Flattener:
    """Makes pictures of `source` into pictures of `target`, which looks from the same place.

    Black where the source sees nothing. Cubic interpolation: a picture keeps its sharpness.
    """

    source: Camera
    target: Camera
    map_px: Float[Array, "height width 2"] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        pixels = resampling_map(self.source, self.target)
        # What is not a number must stay outside the picture, whatever cv2 makes of it.
        object.__setattr__(self, "map_px", np.where(np.isfinite(pixels), pixels, -1e6).astype(np.float32))

    def __call__(self, image: Image, name: str = "the picture") -> Image:
        """The picture as the target camera takes it; raises MixedImageSizes for one of another size."""
        size = (image.shape[1], image.shape[0])
        if size != (self.source.width, self.source.height):
            raise MixedImageSizes("the camera file", (self.source.width, self.source.height), name, size)
        return cv2.remap(
            image, self.map_px[..., 0], self.map_px[..., 1], cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT
        )
