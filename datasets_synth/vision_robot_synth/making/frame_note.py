"""What the tables of a dataset need to know of a frame, as bytes that hold arrays and nothing else."""

import io
from dataclasses import dataclass, fields

import numpy as np

from vision_robot.geometry import SE3
from vision_robot.sim.object_truth import ObjectTruth

__all__ = ["FrameNote"]

POSE = "station_from_object"


@dataclass(frozen=True)
class FrameNote:
    """The truth about the tracked things, and COCO's run lengths of each id that is seen."""

    objects: ObjectTruth
    runs: dict[int, list[int]]

    def to_bytes(self) -> bytes:
        """An .npz archive; reading it back runs no code, whoever wrote it."""
        objects = self.objects
        arrays = {one.name: getattr(objects, one.name) for one in fields(objects) if one.name != POSE}
        arrays["names"] = np.array(objects.names, dtype=str)
        arrays |= {"rotation": objects.station_from_object.rotation}
        arrays |= {"translation": objects.station_from_object.translation}
        arrays["run_ids"] = np.array(list(self.runs), dtype=np.int64)
        arrays["run_counts"] = np.array([len(run) for run in self.runs.values()], dtype=np.int64)
        arrays["run_lengths"] = np.array([n for run in self.runs.values() for n in run], dtype=np.int64)
        archive = io.BytesIO()
        np.savez(archive, **arrays)
        return archive.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> "FrameNote":
        """The note that `to_bytes` wrote."""
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        pose = SE3(arrays.pop("rotation"), arrays.pop("translation"))
        names = tuple(map(str, arrays.pop("names")))
        ids, counts, lengths = (arrays.pop(f"run_{part}") for part in ("ids", "counts", "lengths"))
        parts = np.split(lengths, np.cumsum(counts)[:-1]) if len(ids) else []
        runs = {int(one): part.tolist() for one, part in zip(ids, parts, strict=True)}
        return cls(ObjectTruth(names=names, **{POSE: pose}, **arrays), runs)
