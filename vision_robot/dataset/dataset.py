"""The one type that every labelled video becomes, whatever its layout on disk."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from vision_robot.dataset.flow_files import FlowField, read_flow
from vision_robot.dataset.mask_files import read_ids
from vision_robot.errors import BadDataset, BadParameter
from vision_robot.geometry import SE3, Camera
from vision_robot.geometry.work_plane import WorkPlane
from vision_robot.images import read_image
from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float, Int
from vision_robot.video import Frame, Video

__all__ = ["Dataset", "DatasetObject"]


@dataclass(frozen=True)
class DatasetObject:
    """What is known of an object besides its track."""

    id: int
    name: str
    properties: Mapping[str, object] = field(default_factory=dict)
    """Such as shape, size_m and colour; empty where the layout tells nothing."""


@dataclass(frozen=True)
class Dataset:
    """A labelled video: frames are streamed, masks and flow read when they are asked for.

    What a layout does not tell is empty or None, and so are `flow` and `masks` of frames that
    have none. Frames count from 0.
    """

    name: str
    path: Path
    layout: str
    size: tuple[int, int]
    fps: float
    source: Sequence[Path] | Video
    """The files of the frames in order, or the video that holds them."""
    times_s: Float[Array, "frames"]
    truth: Tracks
    ignored: Tracks = field(default_factory=Tracks.empty)
    """What the labels tell not to count: neither to be found nor wrong when found."""
    camera: Camera | None = None
    cam_from_station: SE3 | None = None
    """Where the station stands before the camera: one pose, or one for each frame where the camera moves."""
    objects: tuple[DatasetObject, ...] = ()
    flow_files: Mapping[int, Path] = field(default_factory=dict)
    """Frame -> file of the true flow from it to the frame `flow_step` later."""
    flow_step: int = 1
    mask_files: Mapping[int, Path] = field(default_factory=dict)
    """Frame -> picture of ids."""
    described: Mapping[str, object] = field(default_factory=dict)
    """All that the dataset says of itself: dataset.json, seqinfo.ini."""

    def __len__(self) -> int:
        return len(self.times_s)

    def __iter__(self) -> Iterator[Frame]:
        return self.frames()

    def frames(self, start: int = 0, stop: int | None = None) -> Iterator[Frame]:
        """Frames `start` to before `stop`, read one at a time.

        Raises BadDataset for a frame that is missing or of another size, UnreadableImage for a damaged one.
        """
        last = len(self) if stop is None else min(stop, len(self))
        if isinstance(self.source, Video):
            for frame in self.source:
                if frame.index >= last:
                    return
                if frame.index >= start:
                    yield Frame(frame.index, float(self.times_s[frame.index]), frame.image)
            return
        for index in range(start, last):
            yield self._read(self.source[index], index)

    def frame(self, index: int) -> Frame:
        """One frame; of a video, by reading all before it. Raises BadParameter for one there is not."""
        if not 0 <= index < len(self):
            raise BadParameter("frame", index, f"from 0 to {len(self) - 1}")
        for frame in self.frames(index, index + 1):
            return frame
        raise BadDataset(self.path, f"frame {index} cannot be decoded")

    def flow(self, index: int) -> FlowField | None:
        """True flow from a frame to the one `flow_step` later; None where there is none."""
        return read_flow(self.flow_files[index]) if index in self.flow_files else None

    def masks(self, index: int) -> Int[Array, "height width"] | None:
        """Id of the object seen at each pixel, 0 for none; None where the frame has no masks."""
        return read_ids(self.mask_files[index]) if index in self.mask_files else None

    def plane(self, index: int = 0) -> WorkPlane | None:
        """The work plane as it is seen in a frame, exactly known; None without camera and pose."""
        if self.camera is None or self.cam_from_station is None:
            return None
        pose = self.cam_from_station
        return WorkPlane.exact(self.camera, pose[index] if pose.translation.ndim > 1 else pose)

    def _read(self, path: Path, index: int) -> Frame:
        if not path.is_file():
            raise BadDataset(self.path, f"frame {index} is missing: there is no {path.name}")
        image = read_image(path)
        size = (image.shape[1], image.shape[0])
        if size != self.size:
            raise BadDataset(
                self.path,
                f"{path.name} is {size[0]}x{size[1]} px, the dataset {self.size[0]}x{self.size[1]} px",
            )
        return Frame(index, float(self.times_s[index]), image)


def even_times(count: int, fps: float) -> Float[Array, "frames"]:
    """Times of frames that follow each other evenly [s]."""
    return np.arange(count) / fps
