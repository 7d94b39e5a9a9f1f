"""Masks of objects: pictures of ids, and the run lengths in which COCO keeps a mask."""

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from vision_robot.errors import BadParameter, BadTable
from vision_robot.images import decoded
from vision_robot.types import Array, Bool, Int, Integer

__all__ = ["decode_runs", "encode_ids", "encode_runs", "read_ids"]

FASTEST = [
    cv2.IMWRITE_PNG_STRATEGY,
    cv2.IMWRITE_PNG_STRATEGY_RLE,
    cv2.IMWRITE_PNG_FILTER,
    cv2.IMWRITE_PNG_FILTER_NONE,
]


def encode_ids(ids: Integer[Array, "height width"]) -> bytes:
    """A PNG whose grey value is the id, of 8 bits, or 16 where an id needs them."""
    largest, least = int(ids.max(initial=0)), int(ids.min(initial=0))
    if least < 0 or largest > 65535:
        raise BadParameter("ids", (least, largest), "from 0 to 65535")
    kind = np.uint8 if largest < 256 else np.uint16
    return cv2.imencode(".png", np.ascontiguousarray(ids, dtype=kind), FASTEST)[1].tobytes()


def read_ids(path: Path | str) -> Int[Array, "height width"]:
    """The ids in such a PNG. Raises BadTable for another file."""
    ids = decoded(path, BadTable)
    if ids.ndim != 2 or ids.dtype.kind != "u":
        raise BadTable(path, f"a picture of ids is grey, this is {ids.dtype} {ids.shape}")
    return ids.astype(np.int64)


def encode_runs(mask: Bool[Array, "height width"], columns: slice = slice(None)) -> list[int]:
    """COCO's run lengths: down the columns, from left to right, first those that are not of the mask.

    Only `columns` are looked at; the others are taken to hold nothing of it.
    """
    height, width = mask.shape
    first, last, _ = columns.indices(width)
    flat = np.asarray(mask[:, first:last], dtype=bool).T.ravel()
    starts_and_ends = np.flatnonzero(np.diff(flat, prepend=False, append=False)) + first * height
    counts = np.diff(starts_and_ends, prepend=0, append=width * height).tolist()
    return counts if len(counts) == 1 or counts[-1] else counts[:-1]


def decode_runs(counts: Sequence[int], size: tuple[int, int]) -> Bool[Array, "height width"]:
    """The mask of (width, height) with these run lengths. Raises BadParameter where they do not add up."""
    width, height = size
    runs = np.asarray(counts, dtype=np.int64)
    if runs.ndim != 1 or (runs < 0).any() or int(runs.sum()) != width * height:
        raise BadParameter("run lengths", int(runs.sum()), f"zero or positive, {width * height} in all")
    values = np.arange(len(runs)) % 2 == 1
    return np.repeat(values, runs).reshape(width, height).T
