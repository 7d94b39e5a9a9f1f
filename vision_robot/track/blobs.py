"""What a tracker sees in one frame: a table of blobs."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields

import numpy as np

from vision_robot.errors import BadTable
from vision_robot.types import Array, Float, Int

__all__ = ["Blobs"]


@dataclass(frozen=True)
class Blobs:
    """One row for each object seen in a frame, in no promised order.

    Pixels, boxes and axes are as in `vision_robot.tracks.Tracks`: u right, v down, centre of the first
    pixel at 0; a box is (left, top, width, height) from the outer border of its first pixels; axes are
    the full lengths of the ellipse with the same second moments, major first. Yaw is the direction of
    the major axis in the picture, from u towards v, in [-pi/2, pi/2); NaN where a blob is round.
    """

    centroid_px: Float[Array, "n 2"]
    box_px: Float[Array, "n 4"]
    area_px: Float[Array, "n"]
    axes_px: Float[Array, "n 2"]
    yaw_rad: Float[Array, "n"]
    score: Float[Array, "n"] = field(default_factory=lambda: np.zeros(0))
    """How surely this is an object, from 0 to 1; 1 where the tracker does not say."""
    kind: Int[Array, "n"] = field(default_factory=lambda: np.zeros(0))
    """Which of several things asked for it is, such as the number of its colour; 0 where there is one."""
    extra: Mapping[str, Float[Array, "n"]] = field(default_factory=dict)
    """Further columns by name, such as `solidity`."""

    def __post_init__(self) -> None:
        n = len(self.centroid_px)
        for name, default in (("score", 1.0), ("kind", 0)):
            if not len(getattr(self, name)):
                object.__setattr__(self, name, np.full(n, default))
        for one in fields(self):
            if one.name == "extra":
                continue
            array = np.asarray(getattr(self, one.name), dtype=np.int64 if one.name == "kind" else float)
            if len(array) != n:
                raise BadTable("blobs", f"{one.name} has {len(array)} rows and centroid_px has {n}")
            object.__setattr__(self, one.name, array)

    def __len__(self) -> int:
        return len(self.centroid_px)

    @classmethod
    def empty(cls) -> "Blobs":
        """No rows."""
        none, pairs = np.zeros(0), np.zeros((0, 2))
        return cls(pairs, np.zeros((0, 4)), none, pairs, none)

    @classmethod
    def joined(cls, parts: "list[Blobs]") -> "Blobs":
        """The rows of several tables with the same further columns, one after the other."""
        parts = [part for part in parts if len(part)]
        if not parts:
            return cls.empty()
        columns = {
            one.name: np.concatenate([getattr(part, one.name) for part in parts])
            for one in fields(cls)
            if one.name != "extra"
        }
        extra = {name: np.concatenate([part.extra[name] for part in parts]) for name in parts[0].extra}
        return cls(**columns, extra=extra)

    def rows(self, keep: Array) -> "Blobs":
        """The rows that a mask, slice or index array picks."""
        picked = {one.name: getattr(self, one.name)[keep] for one in fields(self) if one.name != "extra"}
        return Blobs(**picked, extra={name: column[keep] for name, column in self.extra.items()})

    @property
    def eccentricity(self) -> Float[Array, "n"]:
        """Of the ellipse with the same second moments: 0 for a disc, towards 1 for a rod."""
        major, minor = self.axes_px.T
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(major > 0, np.sqrt(np.clip(1 - (minor / major) ** 2, 0, 1)), 0.0)

    @property
    def extent(self) -> Float[Array, "n"]:
        """Area over the area of the box."""
        return self.area_px / (self.box_px[:, 2] * self.box_px[:, 3])
