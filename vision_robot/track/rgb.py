"""Tracker `rgb`: an object is what has its colour."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import cv2
import numpy as np

from vision_robot.errors import BadParameter, NoColour
from vision_robot.track.blob_analysis import analyse_runs
from vision_robot.track.blobs import Blobs
from vision_robot.track.colour_model import ColourModel, cube_colours
from vision_robot.track.colour_names import colour_named
from vision_robot.track.colour_pick import named_region, region_around, region_in, suggestions
from vision_robot.track.crumbs import are_crumbs
from vision_robot.track.edges import analyse_edges
from vision_robot.track.gain import channel_gains
from vision_robot.track.runs import Runs
from vision_robot.track.sieve import AreaSieve
from vision_robot.track.tracker import Remark, Tracker
from vision_robot.types import Array, Bool, Image, UInt8

__all__ = ["Rgb", "RgbOptions"]

SQUARE = np.ones((3, 3), np.uint8)

FEWEST_PX = 12
"""Pixels from which a colour can be learned."""

ADAPT_EVERY = 5
"""Frames between two lessons."""

SURE = 0.8
"""Score from which on a blob teaches its colours."""

GROWN = 3.0
"""An object's pixels may grow by this factor before they stop teaching: no model swallows the scene."""

SAME_LIGHT = 0.005

PATCHY, GROW_PX = 0.97, 3
"""A colour of whose pixels less than this is sure is grown into what lies near and is likelier its own."""

COMPACT = 0.6
"""Share of its ellipse that a thing covers; what noise scatters covers less."""

ALIKE = 5.0
"""Things up to so many times larger or smaller than what was picked count as more of the same."""


@dataclass(frozen=True)
class RgbOptions:
    """What can be asked of `rgb`: things by name, point or box, in this order, each a kind of its own."""

    color: tuple[str, ...] = ()
    """Names: red, blue, ..."""
    pick: tuple[float, ...] = ()
    """Points u,v in the first frame; several one after the other."""
    roi: tuple[float, ...] = ()
    """Boxes left,top,width,height in the first frame; several one after the other."""
    tolerance: float = 12.0
    """How far colours spread around those seen [levels, one standard deviation]."""
    adapt: float = 0.05
    """How fast colours are learned anew, as a share every fifth frame; 0: never."""
    light: bool = True
    """Divide out light that changes as a whole."""
    closing_px: int = 3
    """Gaps up to this are closed."""
    min_area_px: float | None = None
    """Least area; None: what persists from frame to frame."""
    sharp: bool = True
    """Place the edges of blobs between pixels."""

    def __post_init__(self) -> None:
        for name in self.color:
            colour_named(name)
        for name, length in (("pick", 2), ("roi", 4)):
            if len(getattr(self, name)) % length:
                raise BadParameter(f"rgb.{name}", getattr(self, name), f"{length} numbers for each thing")
        if not (np.isfinite(self.tolerance) and 0 < self.tolerance <= 100):
            raise BadParameter("rgb.tolerance", self.tolerance, "above 0 and up to 100 levels")
        if not 0 <= self.adapt <= 1:
            raise BadParameter("rgb.adapt", self.adapt, "from 0 to 1")


class Rgb(Tracker):
    """Odds of object against background over the cube of colours, learned from the first frame and kept up.

    Where nothing is asked for, the colour that stands out most in the first frame is taken, and said.
    """

    name = "rgb"
    Options: ClassVar[type[Any]] = RgbOptions

    def __init__(self, options: RgbOptions | None = None) -> None:
        self.options = options or RgbOptions()
        self.names: list[str] = []
        self._model: ColourModel | None = None
        self._sieves: list[AreaSieve] = []
        self._frame = 0
        self._learned_share: list[float] = []
        self._false_share: list[float] = []
        self._seen_in = np.zeros(0)

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """0, or 1 + the number of the colour, for each pixel of the last frame."""
        return self._mask

    def find(self, frame: Image, time_s: float) -> Blobs:  # noqa: ARG002 - the protocol's signature
        """Objects in the next frame."""
        if self._model is None:
            self._begin(frame)
        elif self.options.light:
            gains = channel_gains(frame, self._reference)
            if np.abs(gains / self._gains - 1).max() > SAME_LIGHT:
                self._gains = gains
                self._ready.light(gains)
        self._frame += 1
        classes = self._ready.classify(frame)
        if min(self._learned_share) < PATCHY:
            # What noise has made sure by chance must not grow.
            classes = self._ready.grown(np.asarray(cv2.medianBlur(classes, 3)), frame, GROW_PX)
        self._mask = np.zeros(classes.shape, dtype=np.uint8)
        found = [self._of_kind(kind, classes, frame) for kind in range(len(self.names))]
        self._seen_in += [len(blobs) > 0 for blobs in found]
        if self.options.adapt and self._frame % ADAPT_EVERY == 0:
            self._adapt(frame, found)
        return Blobs.joined(found)

    def remarks(self) -> tuple[Remark, ...]:
        """How well each colour is told from the rest, and whether it was seen at all."""
        if self._model is None:
            return (("caution", "no frame has been seen"),)
        told: list[Remark] = []
        for kind, name in enumerate(self.names):
            seen = self._seen_in[kind] / max(self._frame, 1)
            if not self._learned_share[kind]:
                told.append(("caution", f"{name}: this colour is not in the first frame"))
            else:
                right, wrong = 100 * self._learned_share[kind], 100 * self._false_share[kind]
                tone = "good" if right > 80 and wrong < 0.5 else "caution"
                told.append(
                    (
                        tone,
                        f"{name}: its mask holds {right:.0f} % of what was shown, {wrong:.2g} % of the rest",
                    )
                )
            if seen < 0.5:
                told.append(("caution", f"{name}: seen in {100 * seen:.0f} % of the frames only"))
        least = ", ".join(f"{sieve.min_area_px:.0f}" for sieve in self._sieves)
        told.append(("note", f"blobs below {least} px are left out"))
        if self.options.light and np.abs(self._gains - 1).max() > 0.05:
            shown = ", ".join(f"{gain:.2f}" for gain in self._gains[::-1])
            told.append(("note", f"the light is {shown} times (red, green, blue) what it was at the start"))
        return tuple(told)

    def figures(self) -> dict[str, float]:
        """For each colour: shares of its own and of other pixels in its mask, least area, frames seen in."""
        figures: dict[str, float] = {}
        for kind, name in enumerate(self.names):
            figures[f"{name}.own_share"] = self._learned_share[kind]
            figures[f"{name}.other_share"] = self._false_share[kind]
            figures[f"{name}.min_area_px"] = self._sieves[kind].min_area_px
            figures[f"{name}.seen_share"] = float(self._seen_in[kind] / max(self._frame, 1))
        return figures

    @property
    def _ready(self) -> ColourModel:
        assert self._model is not None, "frames come first"
        return self._model

    def _begin(self, frame: Image) -> None:
        """Learn the colours from the first frame."""
        asked = list(self._asked(frame))
        self.names = [name for name, _ in asked]
        self._reference, self._gains = frame.copy(), np.ones(3)
        self._sieves = [AreaSieve(self.options.min_area_px) for _ in asked]
        self._seen_in = np.zeros(len(asked))
        self._areas = np.array([region.sum() for _, region in asked], dtype=float)
        model = ColourModel(len(asked), self.options.tolerance)
        self._model = model
        background = ~np.any([self._more_of_it(region, frame) for _, region in asked], axis=0)
        objects = [frame[region] for _, region in asked]
        if all(len(pixels) >= FEWEST_PX for pixels in objects):
            model.learn(objects, frame[background])
        else:
            model.adopt(self._by_name(asked))
        for kind, (pixels, (_, region)) in enumerate(zip(objects, asked, strict=True)):
            enough = len(pixels) >= FEWEST_PX
            self._learned_share.append(float((model.kind_of(pixels) == kind + 1).mean()) if enough else 0.0)
            others = frame[background & ~region]
            self._false_share.append(
                float((model.kind_of(others) == kind + 1).mean()) if len(others) else 0.0
            )

    def _asked(self, frame: Image) -> Iterator[tuple[str, Bool[Array, "height width"]]]:
        """Name and pixels in the first frame of each thing asked for."""
        o = self.options
        for name in o.color:
            yield name, named_region(frame, name)
        for u, v in zip(o.pick[::2], o.pick[1::2], strict=True):
            yield f"at {u:g},{v:g}", region_around(frame, (u, v), 2 * o.tolerance)
        for box in zip(*(o.roi[i::4] for i in range(4)), strict=True):
            yield "in {:g},{:g},{:g},{:g}".format(*box), region_in(frame, box)
        if not (o.color or o.pick or o.roi):
            best = next(iter(suggestions(frame)), None)
            if best is None:
                raise NoColour()
            yield best.colour, named_region(frame, best.colour)

    def _more_of_it(self, region: Bool[Array, "height width"], frame: Image) -> Bool[Array, "height width"]:
        """The region with other things of about its colour and size, which must not count as background."""
        near = cv2.dilate(region.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
        if region.sum() < FEWEST_PX:
            return near
        alone = ColourModel(1, self.options.tolerance)
        alone.learn([frame[region]], frame[:0].reshape(-1, 3))
        runs = Runs.of_mask(cv2.medianBlur(alone.classify(frame), 3))
        blobs, area = analyse_runs(runs), float(region.sum())
        alike = (blobs.area_px > area / ALIKE) & (blobs.area_px < area * ALIKE) & _compact(blobs)
        return near | runs.painted(alike, region.shape)

    def _by_name(self, asked: list[tuple[str, Array]]) -> UInt8[Array, "cells"]:
        """Before a colour has been seen, its name's region of the cube stands for it."""
        table, colours = np.zeros(len(cube_colours()), dtype=np.uint8), cube_colours()
        for kind, name in enumerate(self.options.color):
            table[colour_named(name).holds(colours)] = kind + 1
        for kind, (name, region) in enumerate(asked):
            if kind >= len(self.options.color) and region.sum() < FEWEST_PX:
                raise BadParameter(f"thing {name}", f"{int(region.sum())} px", f"{FEWEST_PX} px or more")
        return table

    def _of_kind(self, kind: int, classes: UInt8[Array, "height width"], frame: Image) -> Blobs:
        mask = (
            classes
            if len(self.names) == 1
            else np.asarray(cv2.compare(classes, _whole(kind + 1), cv2.CMP_EQ))
        )
        mask = cv2.medianBlur(mask, 3)
        if self.options.closing_px > 1:
            square = np.ones((self.options.closing_px,) * 2, np.uint8)
            mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, square)
        runs = Runs.of_mask(np.asarray(mask, dtype=np.uint8))
        found = analyse_runs(runs, axes="matlab", kind=kind)
        kept = self._sieves[kind].accepts(found)
        if self.options.sharp and kept.any():
            found, runs = analyse_edges(runs.painted(kept.astype(np.uint8), classes.shape), frame, kind=kind)
            kept = found.area_px >= self._sieves[kind].min_area_px
        kept &= ~are_crumbs(runs, found.area_px, (frame.shape[0], frame.shape[1]))
        if kept.any():
            self._mask += runs.painted(np.where(kept, kind + 1, 0).astype(np.uint8), classes.shape) * (
                self._mask == 0
            )
        return replace(found, score=self._sieves[kind].scores(found)).rows(kept)

    def _adapt(self, frame: Image, found: list[Blobs]) -> None:
        """Pixels well inside of sure blobs teach their kind, those far from all blobs the background."""
        objects = []
        for kind, blobs in enumerate(found):
            area = float(blobs.area_px.sum())
            sure = len(blobs) > 0 and float(blobs.score.max()) >= SURE and area >= FEWEST_PX
            if self._areas[kind] >= FEWEST_PX:
                sure = sure and area < GROWN * self._areas[kind]
            inner = cv2.erode((self._mask == kind + 1).astype(np.uint8), SQUARE) > 0 if sure else None
            objects.append(self._even(frame[inner]) if inner is not None else frame[:0].reshape(-1, 3))
            if sure and self._areas[kind] < FEWEST_PX:
                self._areas[kind] = area
        far = cv2.dilate(self._mask, np.ones((9, 9), np.uint8))[::4, ::4] == 0
        if any(map(len, objects)) and all(share > 0 for share in self._learned_share):
            self._ready.adapt(objects, self._even(frame[::4, ::4][far]), self.options.adapt)

    def _even(self, colours: UInt8[Array, "k 3"]) -> UInt8[Array, "k 3"]:
        """Colours as the light of the first frame would show them."""
        return np.clip(colours / self._gains, 0, 255).astype(np.uint8)


def _compact(blobs: Blobs) -> Bool[Array, "n"]:
    """What fills its ellipse, however slender and however it lies."""
    return blobs.area_px > COMPACT * np.pi / 4 * blobs.axes_px.prod(axis=1)


def _whole(value: int) -> Array:
    return np.array([value], dtype=np.float64)
