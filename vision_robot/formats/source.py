"""The bytes of a camera file, read within limits."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from vision_robot.errors import BadCameraFile
from vision_robot.reading import LARGEST_TREE, read_bytes

__all__ = ["CameraSource", "open_source"]


@dataclass(frozen=True)
class CameraSource:
    """A camera file in memory, and what the caller knows besides.

    `size` is the picture's (width, height) [px], for files that do not hold it.
    """

    path: Path
    data: bytes
    size: tuple[int, int] | None = None

    @cached_property
    def text(self) -> str:
        """The file as text; raises BadCameraFile where it is binary."""
        try:
            text = self.data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise self.bad(f"byte {error.start} is not text: a text file is expected") from error
        if "\0" in text:
            raise self.bad(f"byte {text.index(chr(0))} is zero: a text file is expected")
        return text.replace("\r\n", "\n").replace("\r", "\n")

    @property
    def suffix(self) -> str:
        """Suffix of the path, in lower case."""
        return self.path.suffix.lower()

    def bad(self, why: str) -> BadCameraFile:
        """The error that says why this file is of no use, in one line."""
        return BadCameraFile(self.path, " ".join(why.split()))


def open_source(path: Path | str, size: tuple[int, int] | None = None) -> CameraSource:
    """Read a camera file whole; raises BadCameraFile where there is none or it is too large."""
    data = read_bytes(path, BadCameraFile, LARGEST_TREE)
    if not data.strip():
        raise BadCameraFile(path, "it is empty")
    return CameraSource(Path(path), data, size)
