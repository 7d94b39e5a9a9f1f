"""Tracker `optical-flow`: what has moved is an object, and stays one while it stands still."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, ClassVar

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.admission import Admission
from vision_robot.track.blob_analysis import analyse_runs
from vision_robot.track.blobs import Blobs
from vision_robot.track.edges import analyse_edges
from vision_robot.track.gain import channel_gains, gain_tables
from vision_robot.track.ghosts import are_ghosts
from vision_robot.track.motion_gate import MotionGate
from vision_robot.track.parting import parted
from vision_robot.track.runs import Runs
from vision_robot.track.shadow import without_shadows
from vision_robot.track.sieve import AreaSieve
from vision_robot.track.still_scene import StillScene
from vision_robot.track.tracker import LooksAhead, Remark, Tracker
from vision_robot.types import Array, Bool, Float, Image, UInt8

__all__ = ["OpticalFlow", "OpticalFlowOptions"]

MOVING_SHARE = 0.1
"""A blob moves where so much of it does."""

SAMPLES, LOOK_AHEAD_S = 15, 10.0
"""Frames whose median is the scene to begin with, and the time they are spread over."""

SAME_LIGHT = 0.003
"""Gains closer to 1 than this are not corrected."""

OWN_LIFE = 10
"""Frames an object must have been seen alone before it is parted from another that it touches."""


@dataclass(frozen=True)
class OpticalFlowOptions:
    """What can be asked of `optical-flow`."""

    back: int = 1
    """Which frame to compare with: 1 the one before, N the Nth back, for slow things."""
    threshold_px: float | None = None
    """Least motion between the two frames; None: from the noise of the flow."""
    hold_s: float = 60.0
    """How long an object that stops stays one."""
    shadows: bool = True
    """Take shadows off objects."""
    closing_px: int | None = None
    """Gaps up to this are closed; None: a hundredth of the picture's height."""
    min_area_px: float | None = None
    """Least area; None: what persists from frame to frame."""
    sharp: bool = True
    """Place the edges of blobs between pixels."""

    def __post_init__(self) -> None:
        if self.back < 1:
            raise BadParameter("optical-flow.back", self.back, "1 or more")
        for name in ("threshold_px", "hold_s", "closing_px", "min_area_px"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value >= 0):
                raise BadParameter(f"optical-flow.{name}", value, "0 or more")


class OpticalFlow(Tracker, LooksAhead):
    """Flow to its minimum, threshold from noise, borders from the still scene, objects that stop kept."""

    name = "optical-flow"
    Options: ClassVar[type[Any]] = OpticalFlowOptions

    def __init__(self, options: OpticalFlowOptions | None = None) -> None:
        self.options = options or OpticalFlowOptions()
        self._sieve = AreaSieve(self.options.min_area_px)
        self._scene: StillScene | None = None
        self._gate: MotionGate | None = None
        self._time_s = -np.inf
        self._ghosts = self._shaken = self._frames = 0

    @property
    def mask(self) -> UInt8[Array, "height width"]:
        """Pixels taken for objects in the last frame."""
        return self._mask

    def learn(self, frames: Iterable[tuple[Array, float]]) -> None:
        """The scene from the first seconds, so that objects there at the start do not leave ghosts."""
        admission, kept = Admission(), []
        start_s, due_s = np.inf, -np.inf
        for given, time_s in frames:
            frame = admission.admit(given, time_s)
            start_s = min(start_s, time_s)
            if time_s >= due_s:
                kept.append(frame)
                due_s = time_s + LOOK_AHEAD_S / SAMPLES
            if len(kept) == SAMPLES or time_s - start_s > LOOK_AHEAD_S:
                break
        if kept:
            self._scene = StillScene.of(kept)

    def find(self, frame: Image, time_s: float) -> Blobs:
        """Objects in the next frame."""
        if self._gate is None:
            self._begin(frame)
        assert self._gate is not None
        assert self._scene is not None
        lapse_s = time_s - self._time_s if np.isfinite(self._time_s) else 0.0
        self._time_s = time_s
        self._frames += 1
        seen = self._gate.see(frame)
        frame = self._even(frame)
        if seen is None:
            self._scene.follow(frame, self._mask, lapse_s)
            return Blobs.empty()
        flow, moving = seen
        self._shaken += self._gate.camera_moves
        runs, last_s = self._objects(self._unlike(frame), moving, time_s)
        mask = runs.painted(np.full(runs.count, 255, np.uint8), self._shape)
        mask = self._parted(mask, runs)
        blobs, runs = self._analysed(mask, frame)
        kept = self._sieve.accepts(blobs)
        blobs = replace(blobs, score=self._sieve.scores(blobs))
        self._remember(runs, kept, flow, last_s)
        kept &= ~self._lay_ghosts(blobs, frame, kept)
        self._scene.follow(frame, cv2.dilate(self._mask, np.ones((5, 5), np.uint8)), lapse_s)
        return blobs.rows(kept)

    def remarks(self) -> tuple[Remark, ...]:
        """Noise and thresholds, and whether the camera stood still."""
        if self._gate is None:
            return (("caution", "no frame has been seen"),)
        f = self.figures()
        told: list[Remark] = [
            (
                "note",
                f"still pixels seem to move {f['flow_noise_px']:.2f} px, so motion counts from "
                f"{f['threshold_px']:.2f} px; blobs below {f['min_area_px']:.0f} px are left out",
            )
        ]
        if self._shaken > 0.1 * self._frames:
            share = 100 * self._shaken / self._frames
            why = "fix it, or the still scene is not known"
            told.append(("caution", f"in {share:.0f} % of the frames the camera itself moves: {why}"))
        if self._ghosts:
            told.append(
                ("note", f"{self._ghosts} place(s) that objects had left were given back to the scene")
            )
        return tuple(told)

    def figures(self) -> dict[str, float]:
        """Noise and thresholds."""
        if self._gate is None or self._scene is None:
            return {}
        return {
            "flow_noise_px": self._gate.noise_px,
            "threshold_px": self._gate.threshold_px,
            "noise_levels": self._scene.noise_levels,
            "threshold_levels": self._scene.threshold_levels,
            "closing_px": self._closing,
            "min_area_px": self._sieve.min_area_px,
            "camera_shift_px": float(np.linalg.norm(self._gate.shift_px)),
            "ghosts": self._ghosts,
        }

    def _begin(self, frame: Image) -> None:
        self._gate = MotionGate(frame.shape, self.options.back, self.options.threshold_px)
        self._scene = self._scene or StillScene(frame)
        self._shape = (frame.shape[0], frame.shape[1])
        self._mask = np.zeros(self._shape, np.uint8)
        self._numbers = np.zeros(frame.shape[:2], np.int32)
        self._moved_s = np.full(frame.shape[:2], -np.inf, np.float32)
        self._shifts: dict[int, Array] = {}
        self._ages: dict[int, int] = {}
        gap = self.options.closing_px
        self._closing = round(frame.shape[0] / 100) | 1 if gap is None else int(gap)

    def _even(self, frame: Image) -> Image:
        """The frame in the still scene's light: divided by how much brighter each channel is as a whole."""
        assert self._scene is not None
        gains = channel_gains(frame, self._scene.image)
        if np.abs(gains - 1).max() <= SAME_LIGHT:
            return frame
        return np.asarray(cv2.LUT(frame, gain_tables(1 / gains)), dtype=np.uint8)

    def _unlike(self, frame: Image) -> UInt8[Array, "height width"]:
        """Where the frame does not show the still scene: lone pixels off, gaps closed."""
        assert self._scene is not None
        mask = cv2.medianBlur(self._scene.differs(frame), 3)
        if self._closing > 1:
            mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((self._closing,) * 2, np.uint8))
        return np.asarray(mask, dtype=np.uint8)

    def _objects(
        self, unlike: UInt8[Array, "height width"], moving: UInt8[Array, "h w"], time_s: float
    ) -> tuple[Runs, Float[Array, "height width"]]:
        """Blobs that move or have moved lately, and when each pixel's blob last did."""
        runs = Runs.of_mask(unlike)
        if not runs.count:
            return runs, np.full(self._shape, -np.inf, np.float32)
        label, u, v = runs.pixels()
        at = label - 1
        scale = 2.0 ** -(self._gate.halvings if self._gate else 0)
        rows = np.minimum((v * scale).astype(int), moving.shape[0] - 1)
        columns = np.minimum((u * scale).astype(int), moving.shape[1] - 1)
        area = np.bincount(at, minlength=runs.count)
        share = np.bincount(at, moving[rows, columns] > 0, minlength=runs.count) / np.maximum(area, 1)
        order = np.argsort(at, kind="stable")
        first = np.searchsorted(at[order], np.arange(runs.count))
        last = np.maximum.reduceat(self._moved_s[v, u][order], first).astype(float)
        last[share > MOVING_SHARE] = time_s
        objects = time_s - last <= self.options.hold_s
        when = np.where(objects, last, -np.inf).astype(np.float32)
        moved_s = np.full(self._shape, -np.inf, np.float32)
        moved_s[v, u] = when[at]
        return Runs.of_mask(runs.painted(objects.astype(np.uint8), self._shape)), moved_s

    def _parted(self, mask: UInt8[Array, "height width"], runs: Runs) -> UInt8[Array, "height width"]:
        """The mask cut between objects that touch."""
        if len(self._shifts) < 2 or not runs.count:
            return mask
        label, u, v = runs.pixels()
        at = label - 1
        under = self._numbers[v, u]
        for k in range(runs.count):
            inside = at == k
            met = [n for n in np.unique(under[inside]) if n and self._ages.get(int(n), 0) >= OWN_LIFE]
            if len(met) < 2:
                continue
            left, right, top, bottom = (
                u[inside].min(),
                u[inside].max() + 1,
                v[inside].min(),
                v[inside].max() + 1,
            )
            part = np.s_[top:bottom, left:right]
            own = np.zeros((bottom - top, right - left), np.uint8)
            own[v[inside] - top, u[inside] - left] = 255
            shifts = {int(n): self._shifts[int(n)] for n in met}
            cut = parted(own, self._numbers[part], shifts)
            mask[part][(own > 0) & (cut == 0)] = 0
        return mask

    def _analysed(self, mask: UInt8[Array, "height width"], frame: Image) -> tuple[Blobs, Runs]:
        assert self._scene is not None
        behind = self._scene.image
        if self.options.shadows:
            mask, behind = without_shadows(mask, frame, behind, self._scene.noise_levels)
        if self.options.sharp:
            return analyse_edges(mask, frame, behind)
        runs = Runs.of_mask(mask)
        return analyse_runs(runs, axes="matlab"), runs

    def _remember(
        self,
        runs: Runs,
        kept: Bool[Array, "n"],
        flow: Float[Array, "2 h w"],
        moved_s: Float[Array, "height width"],
    ) -> None:
        """Which object is where, since when, and how it moves, for the next frame."""
        before, ages = self._numbers, self._ages
        self._numbers = runs.painted(
            np.where(kept, np.arange(1, runs.count + 1), 0).astype(np.int32), self._shape
        )
        self._mask = np.where(self._numbers > 0, np.uint8(255), np.uint8(0))
        self._moved_s = np.where(cv2.dilate(self._mask, np.ones((5, 5), np.uint8)) > 0, moved_s, -np.inf)
        self._shifts, self._ages = {}, {}
        label, u, v = runs.pixels()
        at = label - 1
        scale = 2.0 ** -(self._gate.halvings if self._gate else 0)
        order = np.argsort(at, kind="stable")
        edges = np.searchsorted(at[order], np.arange(runs.count + 1))
        for k, (a, b) in enumerate(pairwise(edges)):
            if not kept[k] or a == b:
                continue
            some = order[a:b][:: max(1, (b - a) // 500)]
            rows = np.minimum((v[some] * scale).astype(int), flow.shape[1] - 1)
            columns = np.minimum((u[some] * scale).astype(int), flow.shape[2] - 1)
            self._shifts[k + 1] = np.median(flow[:, rows, columns], axis=1) / self.options.back
            old = np.bincount(before[v[some], u[some]])
            old[0] = 0
            self._ages[k + 1] = 1 + (ages.get(int(old.argmax()), 0) if old.any() else 0)

    def _lay_ghosts(self, blobs: Blobs, frame: Image, kept: Bool[Array, "n"]) -> Bool[Array, "n"]:
        """Blobs that stand still and are outlined in the scene, not in the frame: given back to the scene."""
        assert self._scene is not None
        assert self._gate is not None
        found = np.zeros(len(blobs), dtype=bool)
        still = [
            k for k in np.flatnonzero(kept) if np.hypot(*self._shifts[int(k) + 1]) < self._gate.threshold_px
        ]
        if not still or self._frames % 5:
            return found
        found[still] = are_ghosts(blobs.rows(np.array(still)), self._mask, frame, self._scene.image)
        for k in np.flatnonzero(found):
            where = cv2.dilate((self._numbers == k + 1).astype(np.uint8), np.ones((7, 7), np.uint8)) > 0
            self._scene.take(frame, where)
            self._mask[where] = 0
            self._moved_s[where] = -np.inf
        self._ghosts += int(found.sum())
        return found
