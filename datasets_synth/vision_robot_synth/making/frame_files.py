"""Where the files of a frame are, and the notes by which a killed run goes on."""

import pickle
import shutil
from dataclasses import dataclass
from pathlib import Path

from vision_robot.files import write_bytes
from vision_robot.sim.object_truth import ObjectTruth

__all__ = ["FRAME", "MASK", "FrameNote", "Workshop", "flow_pattern"]

FRAME, MASK = "frames/{:06d}.png", "truth/masks/{:06d}.png"


def flow_pattern(suffix: str) -> str:
    """Where the flow of a frame is."""
    return f"truth/flow/{{:06d}}.{suffix}"


@dataclass(frozen=True)
class FrameNote:
    """What the tables of the dataset need to know of a frame."""

    objects: ObjectTruth
    runs: dict[int, list[int]]
    """COCO's run lengths of each id that is seen."""


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
        write_bytes(self.notes / f"{frame:06d}", pickle.dumps(note))

    def note(self, frame: int) -> FrameNote:
        """The note of a finished frame."""
        # These bytes are this program's own, under a name that says from what they were made.
        return pickle.loads((self.notes / f"{frame:06d}").read_bytes())

    def missing(self, count: int) -> list[int]:
        """Frames that are not done."""
        done = {path.name for path in self.notes.glob("[0-9]*")}
        return [frame for frame in range(count) if f"{frame:06d}" not in done]

    def clear_notes(self) -> None:
        """Take the notes away."""
        shutil.rmtree(self.notes, ignore_errors=True)
