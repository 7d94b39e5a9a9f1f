"""Corners and board points in plain text: published sets calibrate without pictures.

A file is whitespace-separated numbers read as consecutive x, y pairs; line breaks mean
nothing and ``#`` starts a comment. One file holds the board, in its own unit of length;
one file for each view holds what was seen, in the same order, in pixels.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.errors import BadCornerFile, BadParameter
from vision_robot.reading import number, read_text
from vision_robot.types import Array, Float

__all__ = ["read_corner_folder", "read_model_points", "size_holding"]


def read_model_points(path: Path | str) -> Float[Array, "n 3"]:
    """Board points with z = 0, in the file's own unit of length."""
    pairs = _read_pairs(Path(path))
    if len(np.unique(pairs, axis=0)) < len(pairs):
        raise BadCornerFile(path, "two board points are the same")
    return np.concatenate([pairs, np.zeros((len(pairs), 1))], axis=1)


def read_corner_folder(folder: Path | str, points: int, *, leave_out: Sequence[Path] = ()) -> list[Corners]:
    """Corners of every text file in a folder, in the order of their names.

    `points` is how many each file must hold; `leave_out` names files that are something
    else. Raises BadCornerFile for a file with another count or with words in it.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise BadParameter("--corners", str(folder), "a folder with one text file of corners for each view")
    skipped = {path.resolve() for path in leave_out}
    files = sorted(
        path
        for path in folder.iterdir()
        if path.is_file() and not path.name.startswith(".") and path.resolve() not in skipped
    )
    if not files:
        raise BadParameter("--corners", str(folder), "a folder with one text file of corners for each view")
    views = []
    for path in files:
        pixels = _read_pairs(path)
        if len(pixels) != points:
            raise BadCornerFile(path, f"it holds {len(pixels)} points where the model has {points}")
        if len(np.unique(pixels, axis=0)) < points:
            raise BadCornerFile(path, "two of its corners lie at the same place")
        views.append(Corners(path.name, np.arange(points), pixels))
    return views


def size_holding(corners: Sequence[Corners]) -> tuple[int, int]:
    """The smallest usual picture size (width, height) that holds all corners."""
    pixels = np.concatenate([view.pixels for view in corners])
    if pixels.min() < -0.5:
        raise BadParameter("corner coordinates", float(pixels.min()), "inside the picture: give --image-size")
    right, below = pixels.max(axis=0) + 0.5
    for width, height in USUAL_SIZES:
        if right <= width and below <= height:
            return width, height
    return int(np.ceil(right)), int(np.ceil(below))


USUAL_SIZES = (
    (320, 240), (640, 480), (800, 600), (1024, 768), (1280, 720), (1280, 960), (1280, 1024),
    (1600, 1200), (1920, 1080), (1920, 1200), (2048, 1536), (2592, 1944), (3840, 2160), (4096, 3072),
)  # fmt: skip


def _read_pairs(path: Path) -> Float[Array, "n 2"]:
    text = read_text(path, BadCornerFile)
    numbers = []
    for line_number, line in enumerate(text.splitlines(), start=1):
        for word in line.split("#")[0].replace(",", " ").split():
            value = number(word)
            if value is None:
                raise BadCornerFile(path, f"line {line_number} holds {word[:40]!r} where a number belongs")
            numbers.append(value)
    values = np.array(numbers)
    if not len(values) or len(values) % 2:
        raise BadCornerFile(path, f"it holds {len(values)} numbers where x, y pairs belong")
    if not np.isfinite(values).all():
        raise BadCornerFile(path, "it holds a number that is not finite")
    return values.reshape(-1, 2)
