"""Camera files of this and other tools.

Every format converts to our conventions at its border: pixel (0, 0) is the centre of the first
pixel, K acts on columns, coefficients in OpenCV's order (CONVENTIONS.md).
"""

from importlib import import_module
from pathlib import Path

from vision_robot.errors import BadParameter, VisionRobotError
from vision_robot.files import check_place, write_bytes
from vision_robot.formats.camera_format import CameraFormat
from vision_robot.formats.loss import fitted
from vision_robot.formats.native import read_known, write_known
from vision_robot.formats.source import CameraSource, open_source
from vision_robot.geometry import Camera, KnownCamera, lens_named

__all__ = [
    "FORMATS",
    "SUFFIXES",
    "CameraFormat",
    "check_writable",
    "format_named",
    "read_camera",
    "read_cameras",
    "read_known_camera",
    "write_camera",
    "write_known_camera",
]

FORMATS: dict[str, str] = {
    "native": "vision_robot.formats.native:FORMAT",
    "opencv": "vision_robot.formats.opencv:FORMAT",
    "ros": "vision_robot.formats.ros:FORMAT",
    "kalibr": "vision_robot.formats.kalibr:FORMAT",
    "colmap": "vision_robot.formats.colmap:FORMAT",
    "mrcal": "vision_robot.formats.mrcal:FORMAT",
    "matlab": "vision_robot.formats.matlab:FORMAT",
}
"""Name -> where the format is; the order is the order of recognition."""

SUFFIXES: dict[str, str] = {
    ".json": "native",
    ".yml": "opencv",
    ".yaml": "opencv",
    ".xml": "opencv",
    ".txt": "colmap",
    ".cameramodel": "mrcal",
    ".m": "matlab",
    ".mat": "matlab",
}
"""Suffix -> the format written where none is named. Reading goes by content instead."""


def format_named(name: str) -> CameraFormat:
    """The format of that name; raises BadParameter listing those that exist."""
    if name not in FORMATS:
        raise BadParameter("camera format", name, f"one of {', '.join(FORMATS)}")
    module, _, attribute = FORMATS[name].partition(":")
    try:
        return getattr(import_module(module), attribute)
    except Exception as error:
        raise VisionRobotError(f"camera format {name} ({FORMATS[name]}) cannot be loaded: {error}") from error


def read_cameras(
    path: Path | str,
    format: str | None = None,  # noqa: A002
    *,
    size: tuple[int, int] | None = None,
) -> dict[str, Camera]:
    """All cameras of a file by name, in the file's order.

    The format is recognised by content where `format` does not name it. `size` is the
    picture's (width, height) [px] for files that do not hold it. Poses are left aside.
    Raises BadCameraFile, naming the line or key and what was expected there.
    """
    source = open_source(path, size)
    return (format_named(format) if format else _recognised(source)).read(source)


def read_camera(
    path: Path | str,
    format: str | None = None,  # noqa: A002
    *,
    size: tuple[int, int] | None = None,
    name: str | None = None,
) -> Camera:
    """The camera of a file; `name` chooses where it holds several (Kalibr, COLMAP).

    Otherwise as `read_cameras`. Raises BadParameter where `name` is needed or not there.
    """
    cameras = read_cameras(path, format, size=size)
    if name is None and len(cameras) == 1:
        return next(iter(cameras.values()))
    if name not in cameras:
        raise BadParameter(f"name of a camera in {path}", name, f"one of {', '.join(cameras)}")
    return cameras[name]


def write_camera(
    camera: Camera,
    path: Path | str,
    format: str | None = None,  # noqa: A002
    *,
    allow_loss: bool = False,
) -> None:
    """Write a camera whole or not at all; reading it again gives exactly the same numbers.

    The format follows the suffix (`SUFFIXES`) where `format` does not name it. Raises
    BadParameter where the format cannot hold the lens, or would lose a number and
    `allow_loss` is not set, and UnwritableOutput.
    """
    name = _name_for(path, format)
    target = format_named(name)
    suffix = Path(path).suffix.lower()
    write_bytes(path, target.write(fitted(camera, name, target, allow_loss=allow_loss), suffix))


def read_known_camera(
    path: Path | str,
    format: str | None = None,  # noqa: A002
    *,
    size: tuple[int, int] | None = None,
    name: str | None = None,
) -> KnownCamera:
    """As `read_camera`, with the covariance that files of our own carry; exact in all other formats."""
    source = open_source(path, size)
    target = format_named(format) if format else _recognised(source)
    if target is format_named("native"):
        return read_known(source)
    return KnownCamera.exact(read_camera(path, format, size=size, name=name))


def write_known_camera(
    known: KnownCamera,
    path: Path | str,
    format: str | None = None,  # noqa: A002
    *,
    allow_loss: bool = False,
) -> None:
    """As `write_camera`; the covariance is kept by our own format and dropped by all others."""
    if format_named(_name_for(path, format)) is format_named("native"):
        write_bytes(path, write_known(known))
    else:
        write_camera(known.camera, path, format, allow_loss=allow_loss)


def check_writable(path: Path | str, format: str | None, *, model: str, skew: bool) -> None:  # noqa: A002
    """Raise, before any work is done, what `write_camera` would raise for such a camera at that path."""
    name = _name_for(path, format)
    coefficients = len(lens_named(model).coefficient_names)
    probe = Camera(64, 64, 64, 64, 32, 32, 1.0 if skew else 0.0, model, (1e-6,) * coefficients)
    fitted(probe, name, format_named(name))
    check_place(path)


def _name_for(path: Path | str, format: str | None) -> str:  # noqa: A002
    suffix = Path(path).suffix.lower()
    if format is None and suffix not in SUFFIXES:
        known = ", ".join(f"{end} ({name})" for end, name in SUFFIXES.items())
        raise BadParameter("suffix of a camera file", suffix, f"{known}; or name the format")
    return format or SUFFIXES[suffix]


def _recognised(source: CameraSource) -> CameraFormat:
    for name in FORMATS:
        candidate = format_named(name)
        if candidate.matches(source):
            return candidate
    raise source.bad(f"its content is none of {', '.join(FORMATS)}")
