"""What one of two pictures hides: pixels that do not come back when they follow the flow there and back."""

import cv2
import numpy as np

from vision_robot.types import Array, Bool, Float

__all__ = ["occluded", "there_and_back"]


def there_and_back(forward: Float[Array, "2 h w"], backward: Float[Array, "2 h w"]) -> Float[Array, "h w"]:
    """How far each pixel ends from where it began [px]; infinite where it leaves the picture."""
    height, width = forward.shape[1:]
    u, v = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    u, v = u + forward[0], v + forward[1]
    back = [cv2.remap(plane, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE) for plane in backward]
    gap = np.hypot(forward[0] + back[0], forward[1] + back[1])
    gap[(u < 0) | (v < 0) | (u > width - 1) | (v > height - 1)] = np.inf
    return gap


def occluded(
    forward: Float[Array, "2 h w"],
    backward: Float[Array, "2 h w"],
    *,
    slack_px: float = 0.5,
    share: float = 0.1,
) -> Bool[Array, "h w"]:
    """Pixels of the first picture that the second hides or no longer holds.

    A gap counts beyond `slack_px` plus a `share` of the way gone, after Sundaram, Brox and Keutzer (2010).
    """
    way = np.hypot(*forward)
    return there_and_back(forward, backward) > slack_px + share * way
