"""Rigs of cameras: our own JSON, Kalibr's camchain, and one mrcal .cameramodel a camera.

Ours has the keys schema, cameras (a list of name, camera and cam_from_rig) and covariance; only it keeps the
covariance.
"""

import json
from collections.abc import Sequence
from pathlib import Path

from vision_robot.errors import BadParameter
from vision_robot.files import write_bytes, write_text
from vision_robot.formats import kalibr, mrcal, native
from vision_robot.formats.camera_format import CameraFormat
from vision_robot.formats.covariance import covariance_object, read_covariance
from vision_robot.formats.loss import fitted
from vision_robot.formats.parse import parse_json
from vision_robot.formats.pose import pose_object, read_pose, stacked
from vision_robot.formats.source import CameraSource, open_source
from vision_robot.formats.tree import Tree
from vision_robot.geometry import SE3, Camera, CameraRig

__all__ = ["RIG_FORMATS", "SCHEMA", "holds_rig", "read_rig", "rig_object", "write_rig"]

SCHEMA = "vr.rig/1"

RIG_FORMATS = ("native", "kalibr", "mrcal")
"""Formats that hold where cameras are to each other."""


def holds_rig(path: Path | str) -> bool:
    """Whether a file is a rig of our own or a camchain of several cameras."""
    source = open_source(path)
    if native.matches(source):
        return parse_json(source).find("cameras") is not None
    return kalibr.matches(source) and len(kalibr.read(source)) > 1


def read_rig(paths: Sequence[Path | str]) -> CameraRig:
    """A rig from one file, or from one mrcal file for each camera, named by its stem.

    Raises BadCameraFile, naming the key and what was expected there.
    """
    if not paths:
        raise BadParameter("files of a rig", 0, "one or more")
    sources = [open_source(path) for path in paths]
    if len(sources) == 1 and native.matches(sources[0]):
        return _read_native(sources[0])
    if len(sources) == 1 and kalibr.matches(sources[0]):
        cameras = kalibr.read(sources[0])
        return CameraRig.exact(tuple(cameras), tuple(cameras.values()), kalibr.read_poses(sources[0]))
    cameras, poses = {}, []
    for source in sources:
        if not mrcal.matches(source):
            raise source.bad("a rig is one file of ours, one camchain, or a .cameramodel for each camera")
        name = source.path.stem
        if name in cameras:
            raise source.bad(f"two files are called {name}")
        (cameras[name],) = mrcal.read(source).values()
        poses.append(mrcal.read_pose(source))
    return CameraRig.exact(tuple(cameras), tuple(cameras.values()), stacked(poses))


def _read_native(source: CameraSource) -> CameraRig:
    top = parse_json(source)
    listed = top.get("cameras")
    if not isinstance(listed.value, list) or not listed.value:
        raise listed.bad("a list of one or more cameras expected")
    names, cameras, poses = [], [], []
    for i, value in enumerate(listed.value):
        one = Tree(source, value, f"cameras[{i}]")
        names.append(one.get("name").text())
        cameras.append(native.camera_from(one.get("camera")))
        poses.append(read_pose(one.get("cam_from_rig")))
    rig = _checked(source, names, cameras, stacked(poses))
    known = top.find("covariance")
    if known is None:
        return rig
    return CameraRig(rig.names, rig.cameras, rig.cam_from_rig, read_covariance(known, rig.parameter_names))


def _checked(source: CameraSource, names: list[str], cameras: list[Camera], poses: SE3) -> CameraRig:
    try:
        return CameraRig.exact(tuple(names), tuple(cameras), poses)
    except BadParameter as error:
        raise source.bad(str(error)) from error


def rig_object(rig: CameraRig) -> dict[str, object]:
    """The keys of our file, without its schema."""
    return {
        "cameras": [
            {
                "name": name,
                "camera": native.camera_object(camera),
                "cam_from_rig": pose_object(rig.cam_from_rig[i]),
            }
            for i, (name, camera) in enumerate(zip(rig.names, rig.cameras, strict=True))
        ],
        "covariance": covariance_object(rig.parameter_names, rig.covariance),
    }


def write_rig(
    rig: CameraRig,
    path: Path | str,
    format: str | None = None,  # noqa: A002
    *,
    allow_loss: bool = False,
) -> list[Path]:
    """Write a rig; the files written.

    Without `format` a .json is ours, a .yaml or .yml a camchain, and a path without suffix a folder of
    mrcal's NAME.cameramodel. Raises BadParameter where the format lacks a place for a number, as for
    a single camera.
    """
    path = Path(path)
    name = format or {".json": "native", ".yaml": "kalibr", ".yml": "kalibr", "": "mrcal"}.get(path.suffix)
    if name not in RIG_FORMATS:
        raise BadParameter("format of a rig", name or path.suffix, f"one of {', '.join(RIG_FORMATS)}")
    if name == "native":
        write_text(path, json.dumps({"schema": SCHEMA, **rig_object(rig)}, indent=1) + "\n")
        return [path]
    target: CameraFormat = kalibr.FORMAT if name == "kalibr" else mrcal.FORMAT
    cameras = [fitted(camera, name, target, allow_loss=allow_loss) for camera in rig.cameras]
    if name == "kalibr":
        write_bytes(path, kalibr.write_chain(cameras, rig.cam_from_rig))
        return [path]
    files = [path / f"{one}.cameramodel" for one in rig.names]
    for i, file in enumerate(files):
        write_bytes(file, mrcal.write_posed(cameras[i], rig.cam_from_rig[i]))
    return files
