"""The second picture as the first camera position would have seen it, if the flow were right."""

import cv2
import numpy as np

from vision_robot.types import Array, Float

__all__ = ["Warp"]


class Warp:
    """Takes pictures of one (height, width) back along a flow, by bicubic interpolation."""

    def __init__(self, shape: tuple[int, int]):
        height, width = shape
        u, v = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
        self._u, self._v = u, v

    def back(
        self, picture: Float[Array, "h w"], flow: Float[Array, "2 h w"]
    ) -> tuple[Float[Array, "h w"], Float[Array, "h w"]]:
        """picture(p + flow(p)) for every pixel p, and 1 where that lies inside the picture, else 0."""
        height, width = self._u.shape
        u, v = cv2.add(self._u, flow[0]), cv2.add(self._v, flow[1])
        back = cv2.remap(picture, u, v, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
        inside = cv2.bitwise_and(cv2.inRange(u, 0, width - 1), cv2.inRange(v, 0, height - 1))
        return back, inside.astype(np.float32) / 255
