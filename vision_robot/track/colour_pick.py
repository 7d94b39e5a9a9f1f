"""From a point, a box or a name in a picture to the pixels that are meant."""

from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.blob_analysis import analyse
from vision_robot.track.colour_names import COLOURS, colour_named
from vision_robot.types import Array, Bool, Image

__all__ = ["Suggestion", "named_region", "region_around", "region_in", "suggestions"]

SMALLEST, LARGEST = 5e-5, 0.2
"""Areas of things worth suggesting, as shares of the picture."""

SMALL_PX = 20

SMOOTHED = 0.25
"""Noise that a median of 5x5 pixels leaves of one level."""


@dataclass(frozen=True)
class Suggestion:
    """A colour that stands out: its name, a point to pick it at, how many things have it and how large."""

    colour: str
    u_px: int
    v_px: int
    things: int
    share: float
    """Of the picture's pixels that have this colour."""


def region_around(image: Image, point: tuple[float, float], tolerance: float) -> Bool[Array, "height width"]:
    """The connected pixels around (u, v) whose smoothed colours lie within `tolerance` levels of it.

    In a noisy picture by as much more as noise moves what has been smoothed.
    """
    u, v = round(point[0]), round(point[1])
    height, width = image.shape[:2]
    if not (0 <= u < width and 0 <= v < height):
        raise BadParameter("point picked", f"{u},{v}", f"inside the picture of {width}x{height} px")
    smooth = cv2.medianBlur(image, 5)
    noise = 1.4826 * float(np.median(cv2.absdiff(image, smooth)))
    tolerance = min(tolerance + 3 * SMOOTHED * noise, 255.0)
    grown = np.zeros((height + 2, width + 2), dtype=np.uint8)
    flags = 8 | cv2.FLOODFILL_FIXED_RANGE | cv2.FLOODFILL_MASK_ONLY | (1 << 8)
    cv2.floodFill(smooth, grown, (u, v), (0, 0, 0), (tolerance,) * 3, (tolerance,) * 3, flags)
    return grown[1:-1, 1:-1] > 0


def region_in(image: Image, box: tuple[float, float, float, float]) -> Bool[Array, "height width"]:
    """The pixels in a box (left, top, width, height) that are unlike the frame around it.

    Background in the corners of the box is left to the odds: it is common outside too.
    """
    left, top, wide, high = (round(x) for x in box)
    height, width = image.shape[:2]
    if wide < 1 or high < 1 or left < 0 or top < 0 or left + wide > width or top + high > height:
        where = f"{left},{top},{wide},{high}"
        raise BadParameter(
            "region", where, f"left,top,width,height inside the picture of {width}x{height} px"
        )
    region = np.zeros((height, width), dtype=bool)
    region[top : top + high, left : left + wide] = True
    return region


def named_region(image: Image, name: str) -> Bool[Array, "height width"]:
    """The pixels that have a colour of that name."""
    return colour_named(name).holds(image)


def suggestions(image: Image) -> list[Suggestion]:
    """Colours that some few compact things have, the most telling first; hues before shades of grey."""
    image = cv2.medianBlur(image, 5)
    size = image.shape[0] * image.shape[1]
    found = []
    for name, colour in COLOURS.items():
        mask = colour.holds(image).astype(np.uint8)
        share = float(mask.mean())
        if not share:
            continue
        blobs = analyse(mask, min_area_px=max(SMALLEST * size, SMALL_PX))
        blobs = blobs.rows((blobs.area_px <= LARGEST * size) & (blobs.extent > 0.25))
        if not len(blobs):
            continue
        # Best: all pixels of the colour lie in few things.
        tidy = float(blobs.area_px.sum() / mask.sum()) / np.sqrt(len(blobs))
        largest = blobs.rows(np.array([blobs.area_px.argmax()]))
        u, v = _inside(mask, largest.box_px[0])
        found.append((colour.has_hue, tidy, Suggestion(name, u, v, len(blobs), share)))
    found.sort(key=lambda one: (not one[0], -one[1]))
    return [one for _, _, one in found]


def _inside(mask: Array, box: Array) -> tuple[int, int]:
    """The pixel of a box's blob that lies farthest from its edge."""
    left, top, width, height = np.rint(np.add(box, (0.5, 0.5, 0, 0))).astype(int)
    part = np.pad(mask[top : top + height, left : left + width], 1)
    v, u = np.unravel_index(cv2.distanceTransform(part, cv2.DIST_L2, 3).argmax(), part.shape)
    return int(left + u - 1), int(top + v - 1)
