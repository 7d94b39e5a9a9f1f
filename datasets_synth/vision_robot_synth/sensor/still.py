"""A mild stand-in for a camera's sensor: optical blur and noise of the read-out."""

from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Image

__all__ = ["Sensor"]


@dataclass(frozen=True)
class Sensor:
    """Blur of the optics and white noise; positions in the picture stay where they are."""

    blur_px: float = 0.5
    """Standard deviation of a Gaussian blur [px]."""
    noise: float = 1.5
    """Standard deviation of the noise [grey values of 255]."""

    def __post_init__(self) -> None:
        for name in ("blur_px", "noise"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise BadParameter(name, value, "zero or positive")
            object.__setattr__(self, name, float(value))

    def expose(self, image: Image, rng: np.random.Generator) -> Image:
        """The picture as the sensor reads it out."""
        light = image.astype(np.float32)
        if self.blur_px > 0:
            light = cv2.GaussianBlur(light, (0, 0), self.blur_px, borderType=cv2.BORDER_REPLICATE)
        if self.noise > 0:
            light = light + np.float32(self.noise) * rng.standard_normal(light.shape, dtype=np.float32)
        return np.clip(np.rint(light), 0, 255).astype(np.uint8)
