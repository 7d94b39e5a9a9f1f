"""Where the files of a frame are, and the notes by which a killed run goes on."""

import shutil
from dataclasses import dataclass
from pathlib import Path

from vision_robot.errors import BadDataset
from vision_robot.files import write_bytes
from vision_robot.reading import read_bytes
from vision_robot_synth.making.frame_note import FrameNote

__all__ = ["FRAME", "MASK", "Workshop", "flow_pattern"]

LARGEST_NOTE = 256_000_000
"""Bytes."""

FRAME, MASK = "frames/{:06d}.png", "truth/masks/{:06d}.png"


def flow_pattern(suffix: str) -> str:
    """Where the flow of a frame is."""
    return f"truth/flow/{{:06d}}.{suffix}"


@dataclass(frozen=True)
class Workshop:
    """The folder in which a dataset grows, and beside it one with a note for each finished frame.

    A note is written after everything else of its frame, whole or not at all: the frames without
    one are what is left to do.
    """

    folder: Path
    notes: Path

    @classmethod
    def for_dataset(cls, folder: Path, key: str) -> "Workshop":
        """Hidden, next to the place of the dataset, and named after what it is to become."""
        stem = folder.absolute().parent / f".{folder.name}.{key}"
        return cls(Path(f"{stem}.partial"), Path(f"{stem}.notes"))

    def write(self, name: str, data: bytes) -> None:
        """Write a file of the dataset."""
        write_bytes(self.folder / name, data)

    def finish(self, frame: int, note: FrameNote) -> None:
        """Note that a frame is done."""
        write_bytes(self.notes / f"{frame:06d}", note.to_bytes())

    def note(self, frame: int) -> FrameNote:
        """The note of a finished frame. Raises BadDataset for a damaged one."""
        path = self.notes / f"{frame:06d}"
        data = read_bytes(path, BadDataset, LARGEST_NOTE)
        try:
            return FrameNote.from_bytes(data)
        except Exception as error:  # archives break in more ways than numpy has errors for
            raise BadDataset(path, "it is damaged: remove it, and its frame is made anew") from error

    def missing(self, count: int) -> list[int]:
        """Frames that are not done."""
        done = {path.name for path in self.notes.glob("[0-9]*")}
        return [frame for frame in range(count) if f"{frame:06d}" not in done]

    def clear_notes(self) -> None:
        """Take the notes away."""
        shutil.rmtree(self.notes, ignore_errors=True)
