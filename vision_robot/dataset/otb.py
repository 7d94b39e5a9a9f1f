"""The layout of the OTB tracking benchmark: img/ and groundtruth_rect.txt, one object.

A row is left, top, width, height, between commas, tabs or blanks; pixels count from 1. Sequences of
two objects have groundtruth_rect.1.txt and .2.txt.
"""

from pathlib import Path

import numpy as np

from vision_robot.dataset.box_tracks import tracks_of_boxes
from vision_robot.dataset.dataset import Dataset, even_times
from vision_robot.dataset.folder import numbered_pictures, picture_size
from vision_robot.dataset.layout import Layout
from vision_robot.dataset.numbers import read_numbers
from vision_robot.errors import BadTable

__all__ = ["LAYOUT"]

FIRST_PIXEL = 1.5
FPS = 30.0
"""The layout keeps no rate."""


def recognises(folder: Path) -> bool:
    """A sequence folder."""
    return any(folder.glob("groundtruth_rect*.txt"))


def read(folder: Path) -> Dataset:
    """An OTB sequence as a dataset.

    Some sequences are labelled in a part of their frames only; then there are fewer rows, which
    belong to the first ones. A row of a box without size or of no numbers says that the object is not there.
    """
    source = numbered_pictures(folder / "img", "OTB")
    times = even_times(len(source), FPS)
    frames, ids, boxes = [], [], []
    for id_, path in enumerate(sorted(folder.glob("groundtruth_rect*.txt")), start=1):
        rows, lines = read_numbers(path, 4, 4)
        if len(rows) > len(source):
            raise BadTable(path, f"line {lines[len(source)]} is one too many: there are {len(source)} frames")
        there = np.isfinite(rows).all(axis=1) & (rows[:, 2:] > 0).all(axis=1)
        frames.append(np.flatnonzero(there))
        ids.append(np.full(there.sum(), id_))
        boxes.append(rows[there] - (FIRST_PIXEL, FIRST_PIXEL, 0, 0))
    truth = tracks_of_boxes(np.concatenate(frames), np.concatenate(ids), np.concatenate(boxes), times)
    return Dataset(
        name=folder.name,
        path=folder,
        layout="otb",
        size=picture_size(source[0]),
        fps=FPS,
        source=source,
        times_s=times,
        truth=truth,
    )


LAYOUT = Layout("groundtruth_rect.txt", recognises, read)
