"""Some frames side by side with the boxes of truth and method: what a number looks like."""

from base64 import b64encode
from collections.abc import Sequence

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float, Image

__all__ = ["LEGEND", "film_strip"]

FRAME_PX = 200
GAP_PX = 4
QUALITY = 75
WHITE, DARK, ORANGE = (255, 255, 255), (40, 30, 20), (40, 110, 255)
LEGEND = "White boxes are the truth, orange ones the method's answer."


def film_strip(
    frames: Sequence[Image],
    truth: Sequence[Float[Array, "objects 4"]],
    found: Sequence[Float[Array, "objects 4"]],
    *,
    names: Sequence[str] = (),
) -> str:
    """A JPEG as a data URI: frames from left to right, each `FRAME_PX` wide, with boxes and names.

    Boxes are (left, top, width, height) in the frames' pixels, as in `Tracks`; those with NaN are left out.
    """
    import cv2

    if not frames or not len(frames) == len(truth) == len(found) or len(names) not in (0, len(frames)):
        raise BadParameter(
            "film strip: frames, boxes and names",
            (len(frames), len(truth), len(found), len(names)),
            "one or more frames, the same number of each",
        )
    cells = []
    for k, frame in enumerate(frames):
        scale = FRAME_PX / frame.shape[1]
        size = (FRAME_PX, max(1, round(frame.shape[0] * scale)))
        small = cv2.resize(frame, size, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)
        small = cv2.cvtColor(small, cv2.COLOR_GRAY2BGR) if small.ndim == 2 else small.copy()
        for colour, width, boxes in ((DARK, 3, truth[k]), (WHITE, 1, truth[k]), (ORANGE, 2, found[k])):
            _draw(small, np.asarray(boxes, dtype=float).reshape(-1, 4) * scale, colour, width)
        if names:
            for colour, width in ((DARK, 3), (WHITE, 1)):
                place = (5, size[1] - 6)
                cv2.putText(small, names[k], place, cv2.FONT_HERSHEY_SIMPLEX, 0.4, colour, width, cv2.LINE_AA)
        cells.append(small)
    height = max(cell.shape[0] for cell in cells)
    strip = np.full((height, len(cells) * (FRAME_PX + GAP_PX) - GAP_PX, 3), 255, dtype=np.uint8)
    for k, cell in enumerate(cells):
        left = k * (FRAME_PX + GAP_PX)
        strip[: cell.shape[0], left : left + FRAME_PX] = cell
    _, data = cv2.imencode(".jpg", strip, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return "data:image/jpeg;base64," + b64encode(data.tobytes()).decode()


def _draw(picture: Image, boxes: Float[Array, "n 4"], colour: tuple[int, int, int], width: int) -> None:
    import cv2

    for left, top, wide, high in boxes[np.isfinite(boxes).all(axis=1)]:
        # Borders of pixels lie half a pixel before their centres; eighths of a pixel draw smoothly.
        corners = [(round(8 * u), round(8 * v)) for u, v in ((left, top), (left + wide, top + high))]
        cv2.rectangle(picture, corners[0], corners[1], colour, width, cv2.LINE_AA, 3)
