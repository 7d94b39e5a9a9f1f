"""What is measured in one cell of suite `trackers`: a method on a video, its figures or its times."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from vision_robot.dataset import Dataset, open_dataset
from vision_robot.evaluate.peers.command import tracks_of_command
from vision_robot.evaluate.peers.contestants import contestant, contestant_class
from vision_robot.evaluate.sweep import Measured
from vision_robot.evaluate.tracking.examples import Examples, examples_of
from vision_robot.evaluate.tracking.figures import tracking_figures
from vision_robot.evaluate.tracking.labelled import judged, labelled_frames
from vision_robot.evaluate.tracking.pursuit import Pursuit, pursue
from vision_robot.evaluate.tracking.streaming import streamed
from vision_robot.machine.memory import PeakMemory, read_bandwidth
from vision_robot.report.film_strip import film_strip
from vision_robot.tracks import Tracks
from vision_robot.video import Frame
from vision_robot_synth.suites.rendered import rendered_set

__all__ = ["command_figures", "tracker_figures", "tracker_times", "variant_figures"]

HELD_BYTES = 200_000_000
"""Videos up to this are kept in memory for the next methods."""

WARM_UP = 5
"""Frames at the start whose times do not count: libraries are loaded in them."""

MOST_TIMED = 200
"""Frames of one's own video that are timed."""

SHOWN_FRAMES = 4

ODD = ("window", "median_px")
"""Options that are odd numbers."""

CHOSEN = {"threshold": "threshold_factor"}
"""Options whose chosen value has another name among a tracker's figures."""


@dataclass(frozen=True)
class Clip:
    """A labelled video from its first example to its last label, gone through as often as wanted."""

    data: Dataset
    shown: Examples
    range: range
    held: tuple[Frame, ...]

    def __iter__(self) -> Iterator[Frame]:
        return iter(self.held) if self.held else self.data.frames(self.range.start, self.range.stop)

    def __len__(self) -> int:
        return len(self.range)

    def pursued(self, method: str, options: Mapping[str, Any]) -> Pursuit:
        """The method on it."""
        tracker = contestant(method, self.shown, options)
        plane = self.data.plane(self.range.start)
        return pursue(tracker, self, self.data.size, plane=plane, z_m=self.height_m)

    @property
    def height_m(self) -> float:
        """Of the things over the work plane, as a person knows it; 0 where it is not told."""
        heights = self.data.truth.extra.get("z_mm", np.zeros(0))
        return float(np.nanmedian(heights)) / 1e3 if np.isfinite(heights).any() else 0.0

    def strip(self, answer: Tracks) -> str:
        """Some frames with the boxes of truth and answer."""
        chosen = np.linspace(0, len(self) - 1, min(SHOWN_FRAMES, len(self))).round().astype(int)
        numbers = [self.range[k] for k in chosen]
        images = [frame.image for frame in self if frame.index in numbers]
        truth, found = (
            [table.box_px[table.frame == number] for number in numbers]
            for table in judged(self.data, answer, self.range.start)
        )
        return film_strip(images, truth, found, names=[f"frame {number}" for number in numbers])

    def figures(self, answer: Tracks) -> dict[str, float]:
        """Of an answer with the video's own numbers of frames."""
        return tracking_figures(*judged(self.data, answer, self.range.start))


def tracker_figures(
    workspace: Path, method: str, video: Mapping[str, Any], *, strip: bool = False
) -> Measured:
    """All figures but times, and what they look like if that is wanted."""
    clip = _clip(workspace, video)
    answer = clip.pursued(method, {}).tracks
    return Measured(clip.figures(answer), clip.strip(answer) if strip else None)


def variant_figures(
    workspace: Path, method: str, video: Mapping[str, Any], option: str, factor: float
) -> dict[str, float]:
    """The same with one option at `factor` times its usual value, or times what the tracker chose itself."""
    clip, usual = _clip(workspace, video), _usual(method, option)
    if usual is None:
        usual = _chosen(clip, method, option)
    return clip.figures(clip.pursued(method, {option: varied(option, usual, factor)}).tracks)


def command_figures(
    workspace: Path, command: str, video: Mapping[str, Any], *, strip: bool = False
) -> Measured:
    """Figures of a program that reads the video and writes its tracks."""
    clip = _clip(workspace, video)
    images = (frame.image for frame in clip)
    answer = _moved(tracks_of_command(command, images, clip.data.size, clip.data.fps), clip.range.start)
    return Measured(clip.figures(answer), clip.strip(answer) if strip else None)


def tracker_times(workspace: Path, method: str, video: Mapping[str, Any]) -> dict[str, float]:
    """Times of one method on one thread, and the score of one who cannot wait for it."""
    clip = _clip(workspace, video)
    clip = replace(clip, range=clip.range[:MOST_TIMED], held=clip.held[:MOST_TIMED])
    floor_s = clip.data.size[0] * clip.data.size[1] * 3 / read_bandwidth()
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        memory = PeakMemory()
        pursuit = clip.pursued(method, {})
        peak = memory.bytes()
    finally:
        cv2.setNumThreads(threads)
    counted = pursuit.latency_s[WARM_UP:] if len(clip) > 2 * WARM_UP else pursuit.latency_s
    median_s = float(np.median(counted))
    start = clip.range.start
    late = streamed(
        _moved(pursuit.live, -start), clip.data.times_s[clip.range.start : clip.range.stop], pursuit.latency_s
    )
    return {
        "latency_p50_ms": 1e3 * median_s,
        "latency_p99_ms": 1e3 * float(np.quantile(counted, 0.99)),
        "fps": 1 / float(counted.mean()),
        "cpu_s": pursuit.cpu_s,
        "bandwidth_share": floor_s / median_s,
        "peak_memory_mb": peak / 1e6,
        "streaming_success_auc": clip.figures(_moved(late, start))["success_auc"],
    }


def varied(option: str, usual: float, factor: float) -> float:
    """An option's value times a factor, of the kind that the option is."""
    value = usual * factor
    if isinstance(usual, int):
        value = max(1, round(value))
    return int(value) | 1 if option in ODD else value


def _usual(method: str, option: str) -> float | None:
    default: Any = contestant_class(method).Options.__dataclass_fields__[option].default
    return default


def _chosen(clip: Clip, method: str, option: str) -> float:
    """What the tracker chose from the data by the end, the middle one where it chose several."""
    tracker = contestant(method, clip.shown, {})
    pursue(tracker, clip, clip.data.size)
    name = CHOSEN.get(option, option)
    values = [value for key, value in tracker.figures().items() if key.split(".")[-1] == name]
    value = float(np.median(values))
    return int(value) if option.endswith("closing_px") else value


def _clip(workspace: Path, video: Mapping[str, Any]) -> Clip:
    return _held_clip(workspace, tuple(sorted((key, _fixed(value)) for key, value in video.items())))


def _fixed(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


@lru_cache(maxsize=4)
def _held_clip(workspace: Path, video: tuple[tuple[str, Any], ...]) -> Clip:
    told = dict(video)
    data = open_dataset(told["folder"]) if "folder" in told else rendered_set(workspace, **told)
    shown = examples_of(data)
    clip = Clip(data, shown, labelled_frames(data, shown.frame), ())
    fits = len(clip) * data.size[0] * data.size[1] * 3 <= HELD_BYTES
    return replace(clip, held=tuple(clip)) if fits else clip


def _moved(tracks: Tracks, by: int) -> Tracks:
    """The same with other numbers of frames."""
    columns = {one.name: getattr(tracks, one.name) for one in fields(Tracks)}
    return Tracks(**{**columns, "frame": tracks.frame + by})
