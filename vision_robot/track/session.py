"""A whole video through a tracker: frames in, rows of tracks out, one frame at a time."""

import time
from collections.abc import Iterator, Sized
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vision_robot.errors import BadFrame
from vision_robot.geometry.work_plane import WorkPlane
from vision_robot.track.admission import Admission
from vision_robot.track.blobs import Blobs
from vision_robot.track.follow import Follower, FollowOptions
from vision_robot.track.on_plane import OnPlane
from vision_robot.track.sources import Recording, Source, frames_of, open_recording
from vision_robot.track.still_camera import StillCamera
from vision_robot.track.tracker import LooksAhead, Remark, Tracker
from vision_robot.tracks import Tracks
from vision_robot.types import Array
from vision_robot.video import Frame

__all__ = ["Latency", "Session", "Step", "track"]


@dataclass(frozen=True)
class Step:
    """One frame: what was seen in it, and the rows that have become final."""

    frame: Frame
    blobs: Blobs
    now: Tracks
    """Confirmed objects in this frame."""
    placed: Tracks | None
    """The same on the work plane, where there is one."""
    final: Tracks
    """Rows to be kept, of this or of the frames just before."""


class Latency:
    """How long frames took, in classes 5 % apart: its memory does not grow."""

    def __init__(self) -> None:
        self._counts = np.zeros(400)

    def add(self, seconds: float) -> None:
        """One more frame."""
        place = np.log(max(seconds, 1e-6) / 1e-6) / np.log(1.05)
        self._counts[min(int(place), len(self._counts) - 1)] += 1

    def quantile_ms(self, share: float) -> float:
        """The time that this share of frames did not exceed [ms]; NaN without frames."""
        total = self._counts.sum()
        if not total:
            return np.nan
        place = int(np.searchsorted(np.cumsum(self._counts), share * total))
        return 1e3 * 1e-6 * 1.05 ** (place + 0.5)


class Session:
    """Follows one video. Iterate over `run`; afterwards its attributes tell what there is to tell."""

    def __init__(
        self,
        tracker: Tracker,
        *,
        follow: FollowOptions | None = None,
        plane: WorkPlane | None = None,
        z_m: float = 0.0,
    ):
        """`plane` gives millimetres, for objects at the height `z_m` over it."""
        self.tracker = tracker
        self.camera = StillCamera()
        self.latency = Latency()
        self.frames = 0
        self.last: Frame | None = None
        self._follow, self._plane, self._z_m = follow, plane, z_m
        self._follower: Follower | None = None
        self._on_plane: OnPlane | None = None
        self.even_times = True
        self._interval = np.nan

    @property
    def objects(self) -> int:
        """Objects confirmed so far."""
        return self._follower.confirmed if self._follower else 0

    def run(self, source: Source) -> Iterator[Step]:
        """The steps of all frames. After the last one `rest` has the rows that still waited.

        What is recorded (a video, a dataset, whatever has a length) is looked ahead in where the tracker
        can learn from that. Raises BadFrame and
        BadVideo for frames that cannot be used, after all steps before them.
        """
        if isinstance(source, str | Path):
            source = open_recording(source)
        recorded = isinstance(source, Recording | Sized)
        if recorded and isinstance(self.tracker, LooksAhead):
            self.tracker.learn((frame.image, frame.time_s) for frame in frames_of(source))
        for frame in frames_of(source):
            yield self._step(frame)

    def rest(self) -> Tracks:
        """The rows that were waiting for their tracks to be confirmed; to be called once, at the end."""
        parts = self._follower.finish() if self._follower else []
        return Tracks.joined([self._measured(part) for part in parts])

    def remarks(self) -> tuple[Remark, ...]:
        """What the tracker says of itself, and what was seen of camera and clock."""
        told = list(self.tracker.remarks())
        if self.camera.moved_at is not None:
            far, when = self.camera.largest_px, self.camera.moved_at
            moved = f"the camera moved (by up to {far:.1f} px, seen at frame {when})"
            told.append(("caution", f"{moved}: positions before and after do not belong together"))
        elif self.camera.largest_px > 0:
            told.append(("good", f"the camera stood still within {self.camera.largest_px:.2f} px"))
        if not self.even_times:
            told.append(("note", "the frame rate varies; each frame's own time was used"))
        if not self.objects:
            told.append(("caution", "no object was confirmed: nothing was seen often enough"))
        return tuple(told)

    def _step(self, frame: Frame) -> Step:
        size = (frame.image.shape[1], frame.image.shape[0])
        if self._follower is None:
            self._follower = Follower(size, self._follow)
            self._on_plane = OnPlane(self._plane, size, z_m=self._z_m) if self._plane else None
        start = time.perf_counter()
        blobs = self.tracker.step(frame.image, frame.time_s)
        final = self._follower.step(frame.index, frame.time_s, blobs)
        self.latency.add(time.perf_counter() - start)
        self.camera.look(_eight_bits(frame.image))
        self._watch_clock(frame)
        self.frames += 1
        self.last = frame
        now = self._follower.now()
        placed = self._measured(now) if self._on_plane else None
        return Step(frame, blobs, now, placed, self._measured(final))

    def _measured(self, rows: Tracks) -> Tracks:
        return self._on_plane.carry(rows) if self._on_plane else rows

    def _watch_clock(self, frame: Frame) -> None:
        if self.last is None:
            return
        interval = frame.time_s - self.last.time_s
        usual = interval if np.isnan(self._interval) else self._interval
        self.even_times &= bool(abs(interval - usual) < 0.25 * usual)
        self._interval = usual


def track(
    source: Source,
    tracker: Tracker,
    *,
    follow: FollowOptions | None = None,
    plane: WorkPlane | None = None,
    z_m: float = 0.0,
) -> Tracks:
    """All tracks of a video as one table: `vr track video` without its files."""
    session = Session(tracker, follow=follow, plane=plane, z_m=z_m)
    parts = [step.final for step in session.run(source)]
    return Tracks.joined([*parts, session.rest()])


def _eight_bits(image: Array) -> Array:
    """The frame for the watch on the camera; what a tracker took cannot fail here."""
    try:
        return Admission().converted(image)
    except BadFrame:  # pragma: no cover - the tracker has refused it before
        return image
