"""Tracker `background`: what differs from the median of the past is an object."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.admission import Admission
from vision_robot.track.background_model import BackgroundModel, Strip
from vision_robot.track.blob_analysis import analyse_runs
from vision_robot.track.blobs import Blobs
from vision_robot.track.edges import analyse_edges
from vision_robot.track.gain import channel_gains, gain_tables
from vision_robot.track.ghosts import are_ghosts
from vision_robot.track.level_noise import LevelNoise
from vision_robot.track.runs import Runs
from vision_robot.track.shadow import without_shadows
from vision_robot.track.sieve import AreaSieve
from vision_robot.track.tracker import LooksAhead, Remark, Tracker
from vision_robot.types import Array, Image, UInt8

__all__ = ["Background", "BackgroundOptions"]

SQUARE = np.ones((3, 3), np.uint8)

START_FACTOR, LEAST_FACTOR, MOST_FACTOR = 5.0, 4.0, 8.0
"""Threshold over noise: where it starts, and the bounds of what single noisy pixels move it to."""

SPECKLES = 1e-4
"""Share of pixels that may be lone false alarms."""

LEAST_LEVELS = 3.0
"""No threshold below this: cameras and codecs round to whole levels."""

SAME_LIGHT = 0.003
"""Gains closer to 1 than this are not corrected."""

EVERYWHERE = 0.6
"""Where more of the picture than this is foreground, the scene has changed."""

QUANTILE, SPREAD_FACTOR = 0.7, 2.5
"""Which quantile of its own differences is a pixel's spread, and how far above it its threshold lies."""

GHOST_EVERY_S = 0.4
ROLLING = 0.05
"""Weight of a new frame in the running figures."""


@dataclass(frozen=True)
class BackgroundOptions:
    """What can be asked of `background`."""

    window: int = 31
    """Samples of each pixel in the median; odd."""
    span_s: float = 15.0
    """Time over which they are spread; 0: the last `window` frames."""
    colour: str = "rgb"
    """rgb, or grey: three times as fast, and blind to what differs in hue alone."""
    threshold: float | None = None
    """Difference from the background in standard deviations of noise; None: as few as lone speckles allow."""
    hold_s: float = 60.0
    """How long an object that stops stays one before it becomes background."""
    light: bool = True
    """Divide out light that changes as a whole."""
    shadows: bool = True
    """Take shadows off objects."""
    closing_px: int | None = None
    """Gaps up to this are closed; None: a hundredth of the picture's height."""
    min_area_px: float | None = None
    """Least area; None: what persists from frame to frame."""
    sharp: bool = True
    """Place the edges of blobs between pixels."""

    def __post_init__(self) -> None:
        if not (3 <= self.window <= 255 and self.window % 2):
            raise BadParameter("background.window", self.window, "an odd number from 3 to 255")
        if self.colour not in ("rgb", "grey"):
            raise BadParameter("background.colour", self.colour, "rgb or grey")
        for name in ("span_s", "hold_s", "threshold", "closing_px", "min_area_px"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value >= 0):
                raise BadParameter(f"background.{name}", value, "0 or more")


class Background(Tracker, LooksAhead):
    """Median background, threshold from noise, shadows off, edges between pixels.

    Objects do not enter the background while they are seen as such, for `hold_s`; light that changes as a
    whole is divided out; a background learned with an object in it is mended when the object leaves; a
    pixel that is restless (leaves, water) gets a threshold of its own.
    """

    name = "background"
    Options: ClassVar[type[Any]] = BackgroundOptions

    def __init__(self, options: BackgroundOptions | None = None) -> None:
        self.options = options or BackgroundOptions()
        self._model: BackgroundModel | None = None
        self._sieve = AreaSieve(self.options.min_area_px)
        self._factor = self.options.threshold or START_FACTOR
        self._figures = {"contrast": np.nan, "foreground_share": np.nan}
        self._restarts = self._ghosts = self._frame = 0
        self._suspects = np.zeros((0, 2))
        self._ghost_check_s = -np.inf

    @property
    def background(self) -> UInt8[Array, "height width *channels"]:
        """The median of each pixel's window, as it is now."""
        return self._ready.image

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """Pixels taken for objects in the last frame."""
        return self._mask

    def learn(self, frames: Iterable[tuple[Array, float]]) -> None:
        """Fill the window from the first `span_s` seconds, so that objects present at the start are seen."""
        admission, kept, skip, start = Admission(), [], 1, None
        for count, (given, time_s) in enumerate(frames):
            start = time_s if start is None else start
            if time_s - start > self.options.span_s:
                break
            if count % skip:
                continue
            frame = self._seen(admission.admit(given, time_s))
            kept.append(frame.copy())
            if len(kept) > self.options.window:
                # As many samples as before, spread twice as wide.
                kept, skip = kept[::2], 2 * skip
        if kept:
            self._settle(kept)

    def _settle(self, kept: list[Array]) -> None:
        """Begin with these frames in the window, in the light of the first."""
        self._begin(kept[0])
        model = self._ready
        for k, frame in enumerate(kept):
            even = self._even(frame) if k else frame
            kept[k] = even
            for strip in model.strips:
                model.take(strip, even[strip.rows], 0.0)
        for strip in model.strips:
            strip.due_s = -np.inf
            self._refresh(strip)
            for even in kept:
                self._follow_spread(even[strip.rows], strip)
            self._refresh(strip)

    def find(self, frame: Image, time_s: float) -> Blobs:
        """Objects in the next frame."""
        seen = self._seen(frame)
        if self._model is None:
            self._begin(seen)
        if self._ready.count == 0:
            self._mask[:] = 0
            self._feed(seen, time_s)
            return Blobs.empty()
        even = self._even(seen)
        difference = cv2.absdiff(cv2.blur(even, (3, 3)), self._smooth)
        mask = self._cleaned(_any_over(difference, self._thresholds))
        blobs = self._analysed(mask, frame, even)
        self._watch(difference, even, blobs, time_s)
        self._feed(even, time_s)
        return blobs

    def remarks(self) -> tuple[Remark, ...]:
        """Noise, threshold, contrast, least area, and what happened to the scene."""
        if self._model is None:
            return (("caution", "no frame has been seen"),)
        f = self.figures()
        told: list[Remark] = [
            (
                "note",
                f"noise {f['noise_levels']:.1f} levels after smoothing; the threshold is "
                f"{f['threshold_factor']:.1f} times that; blobs below {f['min_area_px']:.0f} px are left out",
            )
        ]
        contrast = f["contrast"]
        if np.isfinite(contrast):
            tone = "good" if contrast > 3 else "caution"
            weak = "" if contrast > 3 else ": parts of them may be lost in the background's colour"
            told.append(
                (tone, f"objects stand {contrast:.1f} times the threshold out of the background{weak}")
            )
        else:
            told.append(("caution", "nothing has ever differed from the background"))
        if self._restarts:
            told.append(
                ("caution", f"the scene changed as a whole {self._restarts} time(s) and was learned anew")
            )
        if self._ghosts:
            told.append(("note", f"{self._ghosts} thing(s) learned as background went away and were mended"))
        return tuple(told)

    def figures(self) -> dict[str, float]:
        """Noise, threshold, least area, contrast, share of foreground."""
        if self._model is None:
            return {}
        return {
            "noise_levels": self._noise_levels,
            "threshold_factor": self._factor,
            "closing_px": self._closing,
            "min_area_px": self._sieve.min_area_px,
            **self._figures,
            "samples": self._model.count,
            "scene_changes": self._restarts,
            "ghosts": self._ghosts,
        }

    @property
    def _ready(self) -> BackgroundModel:
        assert self._model is not None, "frames come first"
        return self._model

    @property
    def _noise_levels(self) -> float:
        return float(np.median(self._noise.sigma()))

    def _seen(self, frame: Image) -> Array:
        if self.options.colour == "rgb":
            return frame
        return np.asarray(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY), dtype=np.uint8)

    def _even(self, seen: Image) -> Image:
        """The frame in the background's light: divided by how much brighter each channel is as a whole."""
        if not self.options.light:
            return seen
        gains = channel_gains(seen, self._ready.image)
        if np.abs(gains - 1).max() <= SAME_LIGHT:
            return seen
        table = gain_tables(1 / gains)
        if seen.ndim == 2:
            table = np.ascontiguousarray(table[..., 0])
        return np.asarray(cv2.LUT(seen, table), dtype=np.uint8)

    def _begin(self, seen: Array) -> None:
        self._model = BackgroundModel(seen.shape, self.options.window, self.options.span_s)
        self._noise = LevelNoise(1 if seen.ndim == 2 else 3)
        self._smooth = np.zeros_like(seen)
        self._thresholds = np.full_like(seen, 255)
        self._mask = np.zeros(seen.shape[:2], dtype=np.uint8)
        self._busy = self._mask
        self._since = np.full(seen.shape[:2], np.inf, dtype=np.float32)
        gap = self.options.closing_px
        self._closing = round(seen.shape[0] / 100) | 1 if gap is None else int(gap)
        self._spread = np.zeros(seen.shape[:2], dtype=np.float32)

    def _cleaned(self, raw: UInt8[Array, "height width"]) -> UInt8[Array, "height width"]:
        """Lone pixels off, which also tell whether the threshold is right; gaps closed."""
        mask = cv2.medianBlur(raw, 3)
        if self.options.threshold is None:
            alone = cv2.countNonZero(cv2.subtract(raw, cv2.dilate(mask, SQUARE)))
            step = 1.03 if alone > SPECKLES * raw.size else 0.995
            self._factor = float(np.clip(step * self._factor, LEAST_FACTOR, MOST_FACTOR))
        if self._closing > 1:
            mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((self._closing,) * 2, np.uint8))
        return np.asarray(mask, dtype=np.uint8)

    def _analysed(self, mask: UInt8[Array, "height width"], frame: Image, even: Array) -> Blobs:
        """What is large enough, less its shadow, with its edges between pixels."""
        runs = Runs.of_mask(mask)
        kept = self._sieve.accepts(analyse_runs(runs))
        self._busy = runs.painted(kept.astype(np.uint8), mask.shape)
        objects, behind = self._busy, None
        if even.ndim == 3:
            frame, behind = even, self._ready.image
            if self.options.shadows:
                objects, behind = without_shadows(objects, frame, behind, self._noise_levels)
        if self.options.sharp:
            blobs, runs = analyse_edges(objects, frame, behind)
        else:
            runs = Runs.of_mask(objects)
            blobs = analyse_runs(runs, axes="matlab")
        kept = blobs.area_px >= self._sieve.min_area_px  # shadows may have left crumbs
        self._mask = runs.painted(kept.astype(np.uint8), mask.shape)
        return replace(blobs, score=self._sieve.scores(blobs)).rows(kept)

    def _watch(self, difference: Image, even: Image, blobs: Blobs, time_s: float) -> None:
        """Keep the figures, look for ghosts, and begin anew where the whole scene has changed."""
        share = cv2.countNonZero(self._busy) / self._busy.size
        self._roll("foreground_share", share)
        if share > EVERYWHERE and self._ready.count > 2:
            self._restarts += 1
            self._ready.clear()
            self._mask = np.zeros_like(self._mask)
            self._busy = self._mask
            return
        if len(blobs):
            v, u = np.rint(blobs.centroid_px[:, ::-1]).astype(int).T
            inside = self._busy[v, u] > 0
            if inside.any():
                at = v[inside], u[inside]
                over = difference[at].astype(float) / np.maximum(self._thresholds[at], 1)
                self._roll("contrast", float(np.median(over.reshape(len(over), -1).max(axis=1))))
        if time_s - self._ghost_check_s >= GHOST_EVERY_S and even.ndim == 3:
            self._ghost_check_s = time_s
            self._lay_ghosts(blobs, even)

    def _lay_ghosts(self, blobs: Blobs, even: Image) -> None:
        """What looks like a ghost twice at the same place is one."""
        suspects = blobs.rows(are_ghosts(blobs, self._busy, even, self._ready.image))
        places = suspects.centroid_px
        if len(self._suspects) and len(places):
            apart = np.linalg.norm(places[:, None] - self._suspects[None], axis=2).min(axis=1)
            sure = apart < 2
            where = np.zeros(self._busy.shape, dtype=bool)
            for left, top, width, height in suspects.box_px[sure]:
                part = np.s_[
                    max(int(top) - 2, 0) : int(top + height) + 4,
                    max(int(left) - 2, 0) : int(left + width) + 4,
                ]
                where[part] = cv2.dilate(self._busy[part], np.ones((5, 5), np.uint8)) > 0
            if sure.any():
                self._ghosts += int(sure.sum())
                self._ready.restart(where, even)
                self._since[where] = np.inf
                for strip in self._ready.strips:
                    self._refresh(strip)
        self._suspects = places

    def _feed(self, even: Image, time_s: float) -> None:
        """Let the strips that are due take the frame, and what stood behind the objects in it."""
        self._frame += 1
        strips = self._ready.strips
        turn = strips[self._frame % len(strips)]
        self._learn_noise(even, turn)
        self._follow_spread(even[turn.rows], turn)
        for strip in self._ready.due(time_s):
            samples = even[strip.rows]
            if self._ready.count > self.options.window // 4 and self.options.hold_s:
                samples = self._held(samples, strip, time_s)
            self._ready.take(strip, samples, time_s)
            self._refresh(strip)

    def _held(self, samples: Image, strip: Strip, time_s: float) -> Image:
        """The samples with the background in place of objects that have not been there for too long."""
        busy = cv2.dilate(self._busy[strip.rows], np.ones((5, 5), np.uint8))
        since = self._since[strip.rows]
        if not busy.any():
            since[:] = np.inf
            return samples
        np.minimum(since, time_s, out=since)
        np.copyto(since, np.inf, where=busy == 0)
        held = (busy > 0) & (since > time_s - self.options.hold_s)
        return np.asarray(cv2.copyTo(self._ready.image[strip.rows], held.view(np.uint8), samples.copy()))

    def _refresh(self, strip: Strip) -> None:
        """Smoothed background and thresholds of a strip whose median has changed."""
        top, bottom = strip.rows.start, strip.rows.stop
        above, below = max(top - 1, 0), min(bottom + 1, len(self._smooth))
        smooth = cv2.blur(self._ready.image[above:below], (3, 3))
        self._smooth[strip.rows] = smooth[top - above : bottom - above]
        thresholds = cv2.LUT(self._smooth[strip.rows], self._noise.table(self._factor, LEAST_LEVELS))
        own = np.minimum(SPREAD_FACTOR * self._spread[strip.rows], 255).astype(np.uint8)
        own = own if thresholds.ndim == 2 else cv2.merge((own, own, own))
        self._thresholds[strip.rows] = cv2.max(thresholds, own)

    def _follow_spread(self, samples: Image, strip: Strip) -> None:
        """Move each pixel's spread towards the quantile of what it differs by, by one step."""
        apart = cv2.absdiff(cv2.blur(samples, (3, 3)), self._smooth[strip.rows])
        if apart.ndim == 3:
            apart = cv2.max(cv2.max(apart[..., 0], apart[..., 1]), apart[..., 2])
        spread = self._spread[strip.rows]
        step = np.where(apart > spread, np.float32(QUANTILE), np.float32(QUANTILE - 1))
        step[self._busy[strip.rows] > 0] = 0
        np.maximum(spread + step, 0, out=spread)

    def _learn_noise(self, even: Image, strip: Strip) -> None:
        """From every fourth pixel of a strip, where nothing is."""
        if self._ready.count < 3:
            return
        rows, inner = strip.rows, np.s_[1:-1:2, 1:-1:2]
        smooth, behind = cv2.blur(even[rows], (3, 3))[inner], self._smooth[rows][inner]
        still = (self._busy[rows][inner] == 0).ravel()
        difference = cv2.absdiff(np.ascontiguousarray(smooth), np.ascontiguousarray(behind))
        channels = 1 if behind.ndim == 2 else 3
        self._noise.update(difference.reshape(-1, channels)[still], behind.reshape(-1, channels)[still])

    def _roll(self, name: str, value: float) -> None:
        before = self._figures[name]
        self._figures[name] = value if np.isnan(before) else (1 - ROLLING) * before + ROLLING * value


def _any_over(difference: Image, thresholds: Image) -> UInt8[Array, "height width"]:
    """255 where any channel is above its threshold."""
    over = cv2.compare(difference, thresholds, cv2.CMP_GT)
    if over.ndim == 2:
        return np.asarray(over, dtype=np.uint8)
    return np.asarray(cv2.bitwise_not(cv2.inRange(over, (0, 0, 0), (0, 0, 0))), dtype=np.uint8)
