"""What every camera file format is."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from vision_robot.formats.source import CameraSource
from vision_robot.geometry import LENSES, Camera

__all__ = ["ALL_LENSES", "CameraFormat"]

ALL_LENSES = {name: lens.coefficient_names for name, lens in LENSES.items()}


@dataclass(frozen=True)
class CameraFormat:
    """A file format for intrinsics.

    To add one, write a file with a `FORMAT` and add its line to `FORMATS`.
    """

    title: str
    """What the file is, in a few words."""
    matches: Callable[[CameraSource], bool]
    """Whether content, not name, looks like this format; cheap, and true for a truncated file."""
    read: Callable[[CameraSource], dict[str, Camera]]
    """All cameras of a file by name; raises BadCameraFile."""
    write: Callable[[Camera, str], bytes]
    """(camera, suffix of the file) -> content; gets only cameras that fit."""
    lenses: Mapping[str, tuple[str, ...]]
    """Lens models a file can hold -> the coefficients it has a place for."""
    skew: bool = False
    """Whether a file can hold a skew."""
