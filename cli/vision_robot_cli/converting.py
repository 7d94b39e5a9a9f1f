"""The work of `vr convert`."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from vision_robot.errors import BadParameter
from vision_robot.formats import SUFFIXES, read_camera, read_known_camera, write_known_camera
from vision_robot.formats.loss import pixel_shift
from vision_robot.formats.rig import RIG_FORMATS, holds_rig, read_rig, write_rig
from vision_robot.geometry import Camera, CameraRig, KnownCamera
from vision_robot_cli.output import note
from vision_robot_cli.quantities import whole_pair

__all__ = ["as_text", "converted"]


def converted(
    files: Sequence[Path],
    out: Path,
    source_format: str | None,
    target_format: str | None,
    camera_name: str | None,
    image_size: str | None,
    *,
    allow_loss: bool,
) -> dict[str, Any]:
    """Read, write, read back; what was done, for the person and for --json."""
    size = whole_pair(image_size, "--image-size") if image_size else None
    rig_wanted = target_format is None or target_format in RIG_FORMATS
    if len(files) > 1 or (
        camera_name is None and source_format is None and rig_wanted and holds_rig(files[0])
    ):
        return _rig(files, out, target_format, camera_name, allow_loss=allow_loss)
    known = read_known_camera(files[0], source_format, size=size, name=camera_name)
    write_known_camera(known, out, target_format, allow_loss=allow_loss)
    back = read_camera(
        out, target_format or SUFFIXES[out.suffix.lower()], size=(known.camera.width, known.camera.height)
    )
    return {
        "in": [str(path) for path in files],
        "out": [str(out)],
        "cameras": [asdict(known.camera)],
        "read_back_shift_px": _shift(known.camera, back),
        "covariance": _kept(known, out, target_format),
    }


def _rig(
    files: Sequence[Path], out: Path, target_format: str | None, camera_name: str | None, *, allow_loss: bool
) -> dict[str, Any]:
    rig = read_rig(files)
    if camera_name is not None:
        if camera_name not in rig.names:
            raise BadParameter("--camera-name", camera_name, f"one of {', '.join(rig.names)}")
        index = rig.names.index(camera_name)
        rig = CameraRig.exact((camera_name,), (rig.cameras[index],), rig.cam_from_rig[index : index + 1])
    written = write_rig(rig, out, target_format, allow_loss=allow_loss)
    back = read_rig(written)
    if rig.covariance.any() and not back.covariance.any():
        note(f"{out} has no place for the covariance, which stays behind")
    return {
        "in": [str(path) for path in files],
        "out": [str(path) for path in written],
        "cameras": [asdict(camera) for camera in rig.cameras],
        "read_back_shift_px": max(map(_shift, rig.cameras, back.cameras)),
        "covariance": bool(back.covariance.any()),
    }


def _shift(camera: Camera, back: Camera) -> float:
    return 0.0 if camera == back else pixel_shift(camera, back)


def _kept(known: KnownCamera, out: Path, target_format: str | None) -> bool:
    if known.taken_as_exact:
        return False
    kept = (target_format or SUFFIXES[out.suffix.lower()]) == "native"
    if not kept:
        note(f"{out} has no place for the covariance, which stays behind")
    return kept


def as_text(done: dict[str, Any]) -> str:
    """One line for a person at a terminal."""
    shift = done["read_back_shift_px"]
    exact = "read back without a change" if shift == 0 else f"read back, pixels move by up to {shift:.2g} px"
    count = len(done["cameras"])
    return f"{', '.join(done['out'])}: {count} camera{'s' if count > 1 else ''}, {exact}"
