"""Checked access to what a parser made of a camera file."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from reprlib import Repr

from vision_robot.errors import BadCameraFile
from vision_robot.formats.number import is_number
from vision_robot.formats.source import CameraSource
from vision_robot.reading import LARGEST_NUMBER

__all__ = ["Tree"]

_short = Repr()
_short.maxstring = _short.maxother = 40


@dataclass(frozen=True)
class Tree:
    """A value of a file with the key that leads to it.

    `value` is a dict, a list or a text; numbers stay as the text the file holds, so that
    no digit is lost before it is asked for. All access raises BadCameraFile naming the key
    and what was expected there.
    """

    source: CameraSource
    value: object
    key: str = ""

    def bad(self, why: str) -> BadCameraFile:
        """The error that names this key."""
        return self.source.bad(f"{self.key}: {why}" if self.key else why)

    def names(self) -> tuple[str, ...]:
        """Keys of a dict."""
        if not isinstance(self.value, dict):
            raise self.bad(f"keys with values expected, {_short.repr(self.value)} found")
        return tuple(str(name) for name in self.value)

    def find(self, *names: str) -> "Tree | None":
        """The value under the first of `names` that is there.

        Writers disagree on case and underscores (camera_matrix, Camera_Matrix, cameraMatrix), so
        both are ignored.
        """
        plain = {_plain(name): name for name in reversed(self.names())}
        for name in names:
            if _plain(name) in plain:
                found = plain[_plain(name)]
                assert isinstance(self.value, dict)
                return Tree(self.source, self.value[found], f"{self.key}.{found}" if self.key else found)
        return None

    def get(self, *names: str) -> "Tree":
        """As `find`, for what must be there."""
        found = self.find(*names)
        if found is None:
            raise self.bad(f"{names[0]} is missing")
        return found

    def text(self) -> str:
        """A word."""
        if not isinstance(self.value, str):
            raise self.bad(f"a word expected, {_short.repr(self.value)} found")
        return self.value

    def number_text(self) -> str:
        """A finite number, as written in the file."""
        value = self.value
        if not (isinstance(value, str) and is_number(value) and abs(float(value)) <= LARGEST_NUMBER):
            raise self.bad(f"a finite number expected, {_short.repr(value)} found")
        return value

    def number(self) -> float:
        """A finite number."""
        return float(self.number_text())

    def whole(self) -> int:
        """A whole number."""
        value = self.number()
        if value != int(value):
            raise self.bad(f"a whole number expected, {self.value} found")
        return int(value)

    def pair(self) -> tuple[int, int]:
        """Two whole numbers."""
        first, second = self.numbers(2)
        if first != int(first) or second != int(second):
            raise self.bad(f"two whole numbers expected, {first} and {second} found")
        return int(first), int(second)

    def number_texts(self, *counts: int) -> list[str]:
        """Numbers of a list, nested lists row by row; as many as one of `counts`, if any is given."""
        items = list(self._leaves(self.value, 3))
        if counts and len(items) not in counts:
            wanted = " or ".join(map(str, counts))
            raise self.bad(f"{wanted} numbers expected, {len(items)} found")
        return [Tree(self.source, item, f"{self.key}[{i}]").number_text() for i, item in enumerate(items)]

    def numbers(self, *counts: int) -> list[float]:
        """As `number_texts`, converted."""
        return [float(text) for text in self.number_texts(*counts)]

    def _leaves(self, value: object, depth: int) -> Iterator[object]:
        if not isinstance(value, list):
            raise self.bad(f"a list of numbers expected, {_short.repr(value)} found")
        for item in value:
            if isinstance(item, list) and depth > 1:
                yield from self._leaves(item, depth - 1)
            else:
                yield item


def _plain(name: str) -> str:
    return re.sub(r"_", "", name).lower()
