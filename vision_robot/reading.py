"""Reading files that may come from anywhere, within limits.

Every reader begins here and says which error of its kind a refusal is. Devices and pipes have no end,
gigabytes are no table, and trees may nest deeper or count higher than any program: all of it is refused
in one line before it costs time or memory.
"""

import csv
import io
import json
import math
import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from vision_robot.errors import BadInput

__all__ = [
    "LARGEST_NUMBER",
    "LARGEST_OPTIONS",
    "LARGEST_PICTURE",
    "LARGEST_TABLE",
    "LARGEST_TREE",
    "Refusal",
    "csv_rows",
    "json_tree",
    "number",
    "read_bytes",
    "read_text",
    "toml_tree",
    "xml_root",
]

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,4})?", re.ASCII)
_DOTTED = re.compile(r"""(?<![\w"'-])(?:[\w"'-]+[ \t]*\.[ \t]*){100}""")

Refusal = Callable[[object, str], BadInput]
"""The error to raise, of a path and a reason."""

LARGEST_NUMBER = 1e18
"""Beyond it no length, angle, pixel or count is meant, and squares of sums still have room."""
LARGEST_TREE = 16_000_000
"""Bytes of JSON, YAML, XML: in memory they are up to thirty times as large."""
DEEPEST = 1000
"""Elements of XML in each other."""
LARGEST_OPTIONS = 100_000
"""Bytes of TOML."""
LARGEST_TABLE = 512_000_000
"""Bytes of a table: the tracks of a day of video."""
LARGEST_PICTURE = 2_000_000_000
"""Bytes of an encoded picture, or of a field of flow of 250 million pixels."""


def read_bytes(path: Path | str, refuse: Refusal, largest: int) -> bytes:
    """The bytes of a plain file of at most `largest` bytes."""
    place = Path(path)
    try:
        # Opening a pipe would wait for its other end.
        if not place.is_file():
            raise refuse(path, "it is not a plain file" if place.exists() else "there is no such file")
        if place.stat().st_size > largest:
            raise refuse(path, f"it is larger than {largest // 1_000_000} MB")
        with place.open("rb") as file:
            # Python makes room for as much as it is asked to read.
            return file.read(place.stat().st_size)
    except (OSError, ValueError) as error:
        raise refuse(path, getattr(error, "strerror", None) or str(error)) from error


def read_text(path: Path | str, refuse: Refusal, largest: int = LARGEST_TREE) -> str:
    """The text of such a file, UTF-8 with or without its mark, lines ending in one newline."""
    data = read_bytes(path, refuse, largest)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise refuse(path, f"byte {error.start} is not text in UTF-8") from error
    if "\0" in text:
        raise refuse(path, f"it is not text: character {text.index(chr(0))} is zero")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def number(text: str) -> float | None:
    """The decimal number of a cell, NaN for nan; None for all else, so for 1_000, inf and 1e300."""
    plain = text.strip()
    if _NUMBER.fullmatch(plain) is None:
        return math.nan if plain.lower() == "nan" else None
    value = float(plain)
    return value if abs(value) <= LARGEST_NUMBER else None


def csv_rows(text: str, path: object, refuse: Refusal, mark: str = ",") -> Iterator[tuple[int, list[str]]]:
    """Line and cells of each row that is not empty, one after the other."""
    reader = csv.reader(io.StringIO(text), delimiter=mark)
    while True:
        try:
            row = next(reader, None)
        except csv.Error as error:
            raise refuse(path, f"line {reader.line_num}: {error}") from error
        if row is None:
            return
        if row:
            yield reader.line_num, row


def json_tree(text: str, path: object, refuse: Refusal) -> Any:
    """What JSON says; whole numbers beyond all counting come as floats."""
    try:
        return json.loads(text, parse_int=_whole)
    except json.JSONDecodeError as error:
        raise refuse(path, f"line {error.lineno}: {error.msg}") from error
    except RecursionError as error:
        raise refuse(path, "it is nested too deeply") from error


def toml_tree(text: str, path: object, refuse: Refusal) -> dict[str, Any]:
    """What TOML says."""
    if _DOTTED.search(text):
        # Python's parser takes the square of their number.
        raise refuse(path, "it is no TOML that is read: a key has a hundred dots")
    try:
        return tomllib.loads(text)
    except ValueError as error:  # TOMLDecodeError, and whole numbers of thousands of digits
        raise refuse(path, f"it is no TOML: {error}") from error
    except RecursionError as error:
        raise refuse(path, "it is nested too deeply") from error


def xml_root(data: bytes | str, path: object, refuse: Refusal) -> ElementTree.Element:
    """The root of an XML document without a DOCTYPE, whose entities may multiply without end."""
    try:
        return ElementTree.fromstring(data, ElementTree.XMLParser(target=_Plain()))
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise refuse(path, f"it is no XML that is read ({error})") from error


class _Plain(ElementTree.TreeBuilder):
    depth = 0

    def start(self, tag: str, attrs: dict[str, str]) -> ElementTree.Element:
        self.depth += 1
        if self.depth > DEEPEST:
            raise ValueError(f"it is nested more than {DEEPEST} deep")
        return super().start(tag, attrs)

    def end(self, tag: str) -> ElementTree.Element:
        self.depth -= 1
        return super().end(tag)

    def doctype(self, name: str, pubid: str, system: str) -> None:  # noqa: ARG002 - the parser's signature
        raise ValueError("it has a DOCTYPE")


def _whole(digits: str) -> int | float:
    return int(digits) if len(digits) < 18 else float(digits)
