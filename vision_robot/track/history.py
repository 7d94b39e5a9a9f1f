"""What a report needs of the tracks, small however long the video: thinned paths of the longest tracks."""

from dataclasses import dataclass, field

import numpy as np

from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float

__all__ = ["COLUMNS", "History", "Path"]

COLUMNS = (
    "time_s",
    "u_px",
    "v_px",
    "area_px",
    "yaw_deg",
    "x_mm",
    "y_mm",
    "vx_mm_s",
    "vy_mm_s",
    "vu_px_s",
    "vv_px_s",
)
"""What is kept of each row."""

MOST_POINTS = 600
MOST_PATHS = 200


@dataclass
class Path:
    """One object's rows, every `skip`-th."""

    id: int
    first_frame: int
    last_frame: int
    count: int = 0
    skip: int = 1
    points: list[tuple[float, ...]] = field(default_factory=list)

    def add(self, frame: int, row: tuple[float, ...]) -> None:
        """One more row."""
        self.last_frame = frame
        if self.count % self.skip == 0:
            self.points.append(row)
            if len(self.points) >= MOST_POINTS:
                self.points, self.skip = self.points[::2], 2 * self.skip
        self.count += 1

    @property
    def table(self) -> dict[str, Float[Array, "k"]]:
        """The points by column."""
        return dict(zip(COLUMNS, np.array(self.points).T, strict=True))


class History:
    """Paths by id; when there are too many, the shortest of those that ended are let go."""

    def __init__(self) -> None:
        self.paths: dict[int, Path] = {}
        self.dropped = 0
        self.rows = 0

    def add(self, tracks: Tracks) -> None:
        """Rows in the order of frames."""
        table = tracks.columns()
        missing = np.full(len(tracks), np.nan)
        columns = [np.asarray(table.get(name, missing), dtype=float) for name in COLUMNS]
        for i, row in enumerate(zip(*columns, strict=True)):
            one, frame = int(tracks.id[i]), int(tracks.frame[i])
            self.paths.setdefault(one, Path(one, frame, frame)).add(frame, row)
        self.rows += len(tracks)
        if len(self.paths) > MOST_PATHS and len(tracks):
            self._thin(int(tracks.frame[-1]))

    def longest(self, most: int) -> list[Path]:
        """The paths of most rows, by id."""
        chosen = sorted(self.paths.values(), key=lambda path: -path.count)[:most]
        return sorted(chosen, key=lambda path: path.id)

    def _thin(self, frame: int) -> None:
        ended = [path for path in self.paths.values() if path.last_frame < frame - 50]
        for path in sorted(ended, key=lambda path: path.count)[: len(self.paths) - MOST_PATHS]:
            del self.paths[path.id]
            self.dropped += 1
