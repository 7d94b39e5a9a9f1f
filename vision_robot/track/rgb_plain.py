"""Tracker `rgb-plain`: the text's form, a box in the cube of colours around values read off the object."""

from dataclasses import dataclass
from typing import Any, ClassVar

import cv2
import numpy as np

from vision_robot.errors import BadParameter, NoColour
from vision_robot.track.blob_analysis import analyse
from vision_robot.track.blobs import Blobs
from vision_robot.track.colour_pick import named_region, region_around, region_in, suggestions
from vision_robot.track.tracker import Remark, Tracker
from vision_robot.types import Array, Float, Image, UInt8

__all__ = ["RgbPlain", "RgbPlainOptions"]


@dataclass(frozen=True)
class RgbPlainOptions:
    """What can be asked of `rgb-plain`; the first of these that is given counts."""

    rgb: tuple[float, float, float] | None = None
    """Red, green and blue read off the object."""
    color: tuple[str, ...] = ()
    """One name: the mean of the pixels that have it in the first frame."""
    pick: tuple[float, ...] = ()
    """A point u,v in the first frame, whose colour is read off."""
    roi: tuple[float, ...] = ()
    """A box left,top,width,height in the first frame, whose mean colour is read off."""
    tolerance: float = 40.0
    """Half the side of the box in the cube of colours [levels]."""
    min_area_px: float = 50.0
    """Least area."""

    def __post_init__(self) -> None:
        for name, length in (("color", 1), ("pick", 2), ("roi", 4)):
            if len(getattr(self, name)) not in (0, length):
                raise BadParameter(
                    f"rgb-plain.{name}", getattr(self, name), "one thing: this form knows one box"
                )


class RgbPlain(Tracker):
    """``cv2.inRange`` on a box that never changes."""

    name = "rgb-plain"
    Options: ClassVar[type[Any]] = RgbPlainOptions

    def __init__(self, options: RgbPlainOptions | None = None) -> None:
        self.options = options or RgbPlainOptions()
        self._middle: Float[Array, 3] | None = None
        self._mask = np.zeros((0, 0), dtype=np.uint8)

    def find(self, frame: Image, time_s: float) -> Blobs:  # noqa: ARG002 - the protocol's signature
        """Objects in the next frame."""
        if self._middle is None:
            self._middle = self._read_off(frame)
        low, high = self._middle - self.options.tolerance, self._middle + self.options.tolerance
        self._mask = np.asarray(cv2.inRange(frame, low, high), dtype=np.uint8) & 1
        return analyse(self._mask, axes="matlab", min_area_px=self.options.min_area_px)

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """Pixels inside the box in the last frame."""
        return self._mask

    def remarks(self) -> tuple[Remark, ...]:
        """The box."""
        if self._middle is None:
            return ()
        red, green, blue = self._middle[::-1]
        box = f"red {red:.0f}, green {green:.0f}, blue {blue:.0f}, each ± {self.options.tolerance:g}"
        return (("note", f"the box in the cube of colours is {box}"),)

    def figures(self) -> dict[str, float]:
        """The middle of the box."""
        return (
            {}
            if self._middle is None
            else dict(zip(("blue", "green", "red"), self._middle.tolist(), strict=True))
        )

    def _read_off(self, frame: Image) -> Float[Array, "3"]:
        o = self.options
        if o.rgb is not None:
            return np.array(o.rgb[::-1], dtype=float)
        if o.pick:
            pixels = frame[region_around(frame, (o.pick[0], o.pick[1]), 10.0)]
        elif o.roi:
            pixels = frame[region_in(frame, (o.roi[0], o.roi[1], o.roi[2], o.roi[3]))]
        else:
            names = list(o.color) or [one.colour for one in suggestions(frame)][:1]
            if not names:
                raise NoColour()
            pixels = frame[named_region(frame, names[0])]
        if not len(pixels):
            raise NoColour(o.color[0] if o.color else None)
        return pixels.astype(float).mean(axis=0)
