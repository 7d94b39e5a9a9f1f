"""mrcal's .cameramodel: a Python literal, read here without evaluating it.

LENSMODEL_PINHOLE, LENSMODEL_OPENCV4, 5 and 8, by mrcal's own order fx fy cx cy and OpenCV's
coefficients; other lens models are refused by name. Uncertainty and the inputs of the optimisation are left
aside. The pose, a rotation vector and a translation from the reference to the camera, makes several files
a rig (`vision_robot.formats.rig`); for a single camera it is left aside and written as identity.
"""

import re

import numpy as np

from vision_robot.formats.camera_format import ALL_LENSES, CameraFormat
from vision_robot.formats.intrinsics import make_camera
from vision_robot.formats.number import number_text
from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree
from vision_robot.geometry import SE3, Camera

__all__ = ["FORMAT", "read_pose", "write_posed"]

MODELS = {
    "LENSMODEL_PINHOLE": ("pinhole", 0),
    "LENSMODEL_OPENCV4": ("brown5", 4),
    "LENSMODEL_OPENCV5": ("brown5", 5),
    "LENSMODEL_OPENCV8": ("brown8", 8),
}
"""mrcal's name -> our lens and how many coefficients it has."""


def matches(source: CameraSource) -> bool:
    """A dict literal with mrcal's key."""
    return re.search(rb"['\"](lensmodel|lens_model)['\"]\s*:|LENSMODEL_", source.data) is not None


def read(source: CameraSource) -> dict[str, Camera]:
    """The one camera of the file."""
    # Comments of mrcal stand on lines of their own or behind a value.
    text = re.sub(r"(?m)^[ \t]*#[^\n]*$", "", source.text).strip()
    if not (text.startswith("{") and text.endswith("}")):
        raise source.bad("a dict in braces {...} expected: is it truncated?")
    found = re.search(
        r"['\"](?:lensmodel|lens_model|distortion_model)['\"]\s*:\s*['\"]([^'\"\n]*)['\"]", text
    )
    if found is None:
        raise source.bad("lensmodel is missing")
    name = found[1].replace("DISTORTION", "LENSMODEL")
    if name not in MODELS:
        raise source.bad(f"lensmodel {name} is not supported: one of {', '.join(MODELS)} expected")
    model, count = MODELS[name]
    values = _list(source, text, "intrinsics").numbers(4 + count)
    size = _list(source, text, "imagersize").pair()
    k = [*values[4:], 0.0] if count == 4 else values[4:]
    affine = (values[0], values[1], values[2], values[3], 0.0)
    return {"camera": make_camera(source, size, affine, model, k)}


def read_pose(source: CameraSource) -> SE3:
    """cam_from_reference of the file; raises BadCameraFile where it holds none."""
    text = re.sub(r"(?m)^[ \t]*#[^\n]*$", "", source.text)
    newer = re.search(r"['\"]rt_cam_ref['\"]", text) is not None
    rt = np.array(_list(source, text, "rt_cam_ref" if newer else "extrinsics").numbers(6))
    return SE3.from_rotvec(rt[:3], rt[3:])


def _list(source: CameraSource, text: str, key: str) -> Tree:
    found = re.search(rf"['\"]{key}['\"]\s*:\s*[\[(]([^\]):]*)[\])]", text)
    if found is None:
        raise source.bad(f"{key} is missing or has no end")
    items = [item.strip() for item in found[1].split(",")]
    if items[-1] == "":
        items.pop()
    return Tree(source, items, key)


def write(camera: Camera, suffix: str) -> bytes:  # noqa: ARG001
    """The dict as mrcal lays it out."""
    return write_posed(camera, SE3.identity())


def write_posed(camera: Camera, cam_from_reference: SE3) -> bytes:
    """The same with a pose."""
    name = {"pinhole": "PINHOLE", "brown5": "OPENCV5", "brown8": "OPENCV8"}[camera.model]
    values = (camera.fx, camera.fy, camera.cx, camera.cy, *camera.distortion)
    rt = (*cam_from_reference.rotvec(), *cam_from_reference.translation)
    lines = [
        "{",
        f"    'lensmodel':  'LENSMODEL_{name}',",
        "",
        "    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....",
        f"    'intrinsics': [ {', '.join(map(number_text, values))},],",
        "",
        # The name up to mrcal 2.4, which later versions still read.
        f"    'extrinsics': [ {', '.join(map(number_text, rt))},],",
        "",
        f"    'imagersize': [ {camera.width}, {camera.height},],",
        "}",
    ]
    return ("\n".join(lines) + "\n").encode()


FORMAT = CameraFormat(
    title="mrcal .cameramodel",
    matches=matches,
    read=read,
    write=write,
    lenses={name: ALL_LENSES[name] for name in ("pinhole", "brown5", "brown8")},
)
