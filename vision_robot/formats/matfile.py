"""MATLAB's MAT-file version 5: real numeric arrays and 1 x 1 structs, no more.

From "MAT-File Format" (MathWorks), Level 5. A reader of its own because files may come from
anywhere: every length is checked against what is there, and what unpacks is bounded.
"""

import struct
import zlib
from dataclasses import dataclass

import numpy as np

from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree

__all__ = ["is_matfile", "parse_matfile", "write_matfile"]

MAX_UNPACKED = 16_000_000
MAX_DEPTH = 8
COMPRESSED, MATRIX = 15, 14
STRUCT, OPAQUE = 2, 17
INT32, UINT32 = 5, 6
DTYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}


def is_matfile(source: CameraSource) -> bool:
    """Whether the file begins as a MAT-file does."""
    return source.data.startswith((b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file"))


def parse_matfile(source: CameraSource) -> Tree:
    """Variables by name; structs as dicts, arrays as rows of number texts; the rest is left out."""
    if source.data.startswith(b"MATLAB 7.3"):
        raise source.bad("MAT-files of version 7.3 are not read: save with -v7")
    order = {b"IM": "<", b"MI": ">"}.get(source.data[126:128])
    if order is None:
        raise source.bad("MAT-file: its 128-byte header is damaged")
    variables: dict[str, object] = {}
    budget = MAX_UNPACKED
    cursor = _Cursor(source, source.data[128:], order)
    while cursor.left() >= 8:
        kind, content = cursor.element()
        if kind == COMPRESSED:
            content = _inflated(source, content, budget)
            budget -= len(content)
            kind, content = _Cursor(source, content, order).element()
        if kind == MATRIX:
            name, value = _matrix(_Cursor(source, content, order), 0)
            if value is not None:
                variables[name] = value
    if not variables:
        raise source.bad("MAT-file: no numbers in it; objects must be saved as toStruct(cameraParams)")
    return Tree(source, variables)


@dataclass
class _Cursor:
    """A place in a run of data elements."""

    source: CameraSource
    data: bytes
    order: str
    at: int = 0

    def left(self) -> int:
        return len(self.data) - self.at

    def element(self) -> tuple[int, bytes]:
        """Type and content of the next element; the small form packs both into eight bytes."""
        if self.left() < 8:
            raise self.source.bad("MAT-file: truncated")
        kind, size = struct.unpack_from(f"{self.order}II", self.data, self.at)
        start, end = self.at + 8, self.at + 8 + size
        if kind >> 16:
            kind, size = kind & 0xFFFF, kind >> 16
            start, end = self.at + 4, self.at + 4 + min(size, 4)
            self.at += 8
        else:
            self.at = end if kind == COMPRESSED else end + -size % 8
        if end > len(self.data):
            raise self.source.bad(f"MAT-file: truncated, an element of {size} bytes has no end")
        return kind, self.data[start:end]


def _inflated(source: CameraSource, packed: bytes, budget: int) -> bytes:
    try:
        unpacked = zlib.decompressobj().decompress(packed, max(budget, 1) + 1)
    except zlib.error as error:
        raise source.bad(f"MAT-file: {error}") from error
    if len(unpacked) > budget:
        raise source.bad(f"MAT-file: it unpacks to more than {MAX_UNPACKED // 1_000_000} MB")
    return unpacked


def _matrix(cursor: _Cursor, depth: int) -> tuple[str, object]:
    """Name and value of an array element; value None where it is no number and no struct."""
    if depth > MAX_DEPTH:
        raise cursor.source.bad("MAT-file: nested too deeply")
    if cursor.left() == 0:
        return "", None
    flags = _numbers(cursor, UINT32).tolist()
    if not flags or flags[0] & 0xFF == OPAQUE:
        return "", None
    kind, is_complex = flags[0] & 0xFF, bool(flags[0] & 0x0800)
    shape = _numbers(cursor, INT32).tolist()
    name = cursor.element()[1].decode("ascii", "replace")
    if kind == STRUCT and shape == [1, 1]:
        return name, _struct(cursor, depth)
    if not 6 <= kind <= 15 or len(shape) != 2 or is_complex:
        return name, None
    values = _numbers(cursor)
    if min(shape) < 0 or shape[0] * shape[1] != len(values):
        raise cursor.source.bad(f"MAT-file: {name} is {shape[0]}x{shape[1]} but has {len(values)} numbers")
    texts = [repr(value) for value in values.tolist()]
    # 2**31 x 0 is a legal shape: an empty array is one empty row.
    rows = [texts[row :: shape[0]] for row in range(shape[0] if texts else 1)]
    return name, texts[0] if len(texts) == 1 else rows


def _struct(cursor: _Cursor, depth: int) -> dict[str, object]:
    length = _numbers(cursor, INT32).tolist()
    joined = cursor.element()[1]
    if len(length) != 1 or not 0 < length[0] <= 64:
        raise cursor.source.bad("MAT-file: a struct without field names")
    fields: dict[str, object] = {}
    for start in range(0, len(joined), length[0]):
        name = joined[start : start + length[0]].split(b"\0")[0].decode("ascii", "replace")
        content = cursor.element()[1]
        value = _matrix(_Cursor(cursor.source, content, cursor.order), depth + 1)[1]
        if value is not None:
            fields[name] = value
    return fields


def _numbers(cursor: _Cursor, *wanted: int) -> np.ndarray:
    kind, content = cursor.element()
    if kind not in (wanted or DTYPES):
        raise cursor.source.bad(f"MAT-file: numbers expected, data of type {kind} found")
    dtype = np.dtype(cursor.order + DTYPES[kind])
    return np.frombuffer(content[: len(content) // dtype.itemsize * dtype.itemsize], dtype)


def write_matfile(fields: dict[str, list[list[str]]]) -> bytes:
    """A MAT-file of double arrays, given as rows of number texts."""
    header = b"MATLAB 5.0 MAT-file, camera intrinsics".ljust(124) + struct.pack("<H2s", 0x0100, b"IM")
    body = b""
    for name, rows in fields.items():
        values = np.array([[float(text) for text in row] for row in rows])
        content = _packed(UINT32, struct.pack("<II", 6, 0)) + _packed(
            INT32, struct.pack("<ii", *values.shape)
        )
        content += _packed(1, name.encode()) + _packed(9, values.astype("<f8").tobytes(order="F"))
        body += _packed(MATRIX, content)
    return header + body


def _packed(kind: int, content: bytes) -> bytes:
    return struct.pack("<II", kind, len(content)) + content + bytes(-len(content) % 8)
