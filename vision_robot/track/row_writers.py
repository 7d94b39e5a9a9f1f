"""Files of tracks that grow with the video, so that memory does not; an interrupt keeps what is written."""

import json
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from math import isfinite
from pathlib import Path
from typing import IO, Self

import numpy as np

from vision_robot.errors import BadParameter, UnwritableOutput
from vision_robot.files import atomic_path
from vision_robot.tracks import Tracks

__all__ = ["FORMATS", "RowWriter", "row_writer"]


class RowWriter(ABC):
    """Takes rows as they become final. The file appears when the with block ends, however it ends."""

    def __init__(self, path: Path | str):
        self.path = Path(path)

    def __enter__(self) -> Self:
        self._place = atomic_path(self.path)
        temporary = self._place.__enter__()
        self._file: IO[str] = temporary.open("w", encoding="utf-8", newline="")
        self._count = 0
        self._broken: OSError | None = None
        return self

    def write(self, tracks: Tracks) -> None:
        """Append rows."""
        if len(tracks):
            with self._noting():
                self._append(self._file, tracks, first=self._count == 0)
                self._file.flush()
            self._count += len(tracks)

    def __exit__(self, *exception: object) -> None:
        with suppress(OSError), self._noting():
            self._end(self._file, empty=self._count == 0)
            self._file.close()
        if self._broken is not None:  # the disk is full, and what is written ends anywhere
            error = UnwritableOutput(self.path, self._broken.strerror or str(self._broken))
            self._place.__exit__(type(error), error, None)
            raise error
        # Rows of a video cut short are worth as much as those before any other end.
        self._place.__exit__(None, None, None)

    @contextmanager
    def _noting(self) -> Iterator[None]:
        """Python forgets what it could not write, and closes the file as if nothing were missing."""
        try:
            yield
        except OSError as error:
            self._broken = error
            raise

    @abstractmethod
    def _append(self, file: IO[str], tracks: Tracks, *, first: bool) -> None: ...

    @abstractmethod
    def _end(self, file: IO[str], *, empty: bool) -> None: ...


class CsvRows(RowWriter):
    """The table of `Tracks` as CSV."""

    def _append(self, file: IO[str], tracks: Tracks, *, first: bool) -> None:
        text = tracks.to_csv()
        file.write(text if first else text.split("\n", 1)[1])

    def _end(self, file: IO[str], *, empty: bool) -> None:
        if empty:
            file.write(Tracks.empty().to_csv())


class JsonRows(RowWriter):
    """The same as JSON: {"schema": "vr.tracks/1", "rows": [{...}, ...]}; unknown values are null."""

    def _append(self, file: IO[str], tracks: Tracks, *, first: bool) -> None:
        table = {name: column.tolist() for name, column in tracks.columns().items()}
        for row in zip(*table.values(), strict=True):
            file.write('{"schema": "vr.tracks/1", "rows": [\n' if first else ",\n")
            first = False
            known = {name: value if isfinite(value) else None for name, value in zip(table, row, strict=True)}
            file.write(json.dumps(known, allow_nan=False))

    def _end(self, file: IO[str], *, empty: bool) -> None:
        file.write('{"schema": "vr.tracks/1", "rows": []}\n' if empty else "\n]}\n")


class MotRows(RowWriter):
    """MOTChallenge: frame and id from 1, left, top, width, height, confidence, and three times -1."""

    def _append(self, file: IO[str], tracks: Tracks, *, first: bool) -> None:  # noqa: ARG002
        score = tracks.extra.get("score", np.ones(len(tracks)))
        # Their pixels are counted from 1, and a box begins with its first pixel.
        corner = tracks.box_px[:, :2] + 1.5
        for i in range(len(tracks)):
            left, top = corner[i]
            width, height = tracks.box_px[i, 2:]
            place = f"{left:g},{top:g},{width:g},{height:g}"
            file.write(f"{tracks.frame[i] + 1},{tracks.id[i]},{place},{score[i]:.3f},-1,-1,-1\n")

    def _end(self, file: IO[str], *, empty: bool) -> None:
        pass


FORMATS: dict[str, type[RowWriter]] = {".csv": CsvRows, ".json": JsonRows, ".txt": MotRows}
"""Suffix -> what is written: .txt is MOTChallenge's."""


def row_writer(path: Path | str) -> RowWriter:
    """The writer for a path by its suffix; raises BadParameter listing those there are."""
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        raise BadParameter("file of tracks", str(path), "named *.csv, *.json or *.txt (MOTChallenge)")
    return FORMATS[suffix](path)
