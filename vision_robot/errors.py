"""Everything this library raises on purpose.

One root, `VisionRobotError`; below it `BadInput` for what the caller can mend.
Every message says what is wrong, where, and how to mend it; the evidence is kept
as attributes so that a caller can act on it without parsing text.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

__all__ = [
    "BadCameraFile",
    "BadCornerFile",
    "BadFrame",
    "BadInput",
    "BadParameter",
    "BadTable",
    "BadVideo",
    "BoardNotFound",
    "BrokenPlugin",
    "DegenerateViews",
    "MissingOpenGL",
    "MixedImageSizes",
    "NoColour",
    "NoConvergence",
    "NoImages",
    "TooFewViews",
    "UnreadableImage",
    "UnwritableOutput",
    "VisionRobotError",
]


class VisionRobotError(Exception):
    """Root of all errors of this library."""

    def __reduce__(self) -> tuple[Any, ...]:
        # Exceptions are pickled as a call with their message; ours take the evidence instead, and
        # have to come back from other processes.
        return _rebuilt, (type(self), self.args, self.__dict__)


def _rebuilt(
    cls: type[VisionRobotError], args: tuple[Any, ...], evidence: dict[str, Any]
) -> VisionRobotError:
    error = cls.__new__(cls, *args)
    error.__dict__.update(evidence)
    return error


class NoConvergence(VisionRobotError):
    """An iteration ended without reaching its tolerance."""


class MissingOpenGL(VisionRobotError):
    """No OpenGL back end works on this machine."""

    def __init__(self, tried: dict[str, str]):
        self.tried = tried
        reasons = "; ".join(f"{backend}: {why}" for backend, why in tried.items())
        super().__init__(
            f"no OpenGL back end can render ({reasons}): install one with "
            "'apt-get install libegl1 libgl1 libgl1-mesa-dri' or 'pip install --no-deps lavavu-osmesa'"
        )


class BadInput(VisionRobotError):
    """The caller gave something that cannot be used and can mend it."""


class BadParameter(BadInput):
    """An argument has a value outside what is allowed."""

    def __init__(self, name: str, value: object, allowed: str):
        self.name, self.value, self.allowed = name, value, allowed
        super().__init__(f"{name} is {value!r}: it must be {allowed}")


class NoImages(BadInput):
    """A path names no image."""

    def __init__(self, paths: Iterable[object]):
        self.paths = [str(path) for path in paths]
        super().__init__(
            f"no image found in {', '.join(self.paths) or 'an empty list'}: "
            "give image files, a folder of images, a quoted pattern or a video"
        )


class UnreadableImage(BadInput):
    """A file exists but holds no image that can be decoded."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be read as an image ({why}): remove or replace it")


class MixedImageSizes(BadInput):
    """Images of one camera differ in size."""

    def __init__(self, first: object, size: tuple[int, int], other: object, other_size: tuple[int, int]):
        self.size, self.other_size = size, other_size
        super().__init__(
            f"{other} is {other_size[0]}x{other_size[1]} px but {first} is {size[0]}x{size[1]} px: "
            "one calibration needs images of one camera at one resolution"
        )


class BoardNotFound(BadInput):
    """No image shows the board that was asked for."""

    def __init__(self, images: int, wanted: str, seen: str | None = None):
        self.images, self.wanted, self.seen = images, wanted, seen
        hint = f"; a board of {seen} was seen: try --size {seen}" if seen else "; check --board and --size"
        super().__init__(f"no {wanted} board found in {images} image(s){hint}")


class TooFewViews(BadInput):
    """Fewer usable views than a calibration needs."""

    def __init__(self, usable: int, needed: int, given: int):
        self.usable, self.needed, self.given = usable, needed, given
        super().__init__(
            f"{usable} usable view(s) of {given} given: at least {needed} are needed; "
            "add images that show the whole board at different tilts"
        )


class DegenerateViews(BadInput):
    """The views leave parameters undetermined."""

    def __init__(self, undetermined: Sequence[str], why: str):
        self.undetermined, self.why = tuple(undetermined), why
        affine = {"fx", "fy", "cx", "cy", "skew"} & set(undetermined)
        mend = (
            "add views in which the board is tilted by 20-60 degrees in different directions"
            if affine
            else "take a simpler --model or --fix them, or add views that reach the picture's corners"
        )
        super().__init__(f"{', '.join(undetermined)} cannot be known from these views ({why}): {mend}")


class BadCameraFile(BadInput):
    """A camera file is truncated, unknown or inconsistent."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} is not a camera file this tool can use: {why}")


class BadCornerFile(BadInput):
    """A text file of corners or board points cannot be used."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as corners: {why}")


class BadTable(BadInput):
    """A table in a text file cannot be used."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as a table: {why}")


class BadVideo(BadInput):
    """A video cannot be read or written."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as a video: {why}")


class BadFrame(BadInput):
    """A frame does not belong into the video it was given for."""

    def __init__(self, index: int, why: str):
        self.index, self.why = index, why
        super().__init__(f"frame {index} cannot be used: {why}")


class NoColour(BadInput):
    """The first frame does not show a colour to track."""

    def __init__(self, colour: str | None = None):
        self.colour = colour
        what = f"{colour} is not in the first frame" if colour else "no colour stands out in the first frame"
        super().__init__(f"{what}: pick a point or a region of the object (see `vr track pick`)")


class BrokenPlugin(BadInput):
    """A package names something that cannot be loaded."""

    def __init__(self, name: str, package: str, target: str, why: str):
        self.name, self.package, self.target, self.why = name, package, target, why
        super().__init__(f"{name} of package {package} ({target}) cannot be loaded ({why}): mend or remove")


class UnwritableOutput(BadInput):
    """An output cannot be written where it was asked for."""

    def __init__(self, path: Path | str, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"cannot write {path} ({why}): choose another place with -o")
