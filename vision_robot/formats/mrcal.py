"""mrcal's .cameramodel: a Python literal, read here without evaluating it.

LENSMODEL_PINHOLE, LENSMODEL_OPENCV4, 5 and 8, by mrcal's own order fx fy cx cy and OpenCV's
coefficients; other lens models are refused by name. Pose, uncertainty and the inputs of the
optimisation are left aside; the pose is written as identity.
"""

import re

from vision_robot.formats.camera_format import ALL_LENSES, CameraFormat
from vision_robot.formats.intrinsics import make_camera
from vision_robot.formats.number import number_text
from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree
from vision_robot.geometry import Camera

__all__ = ["FORMAT"]

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
    name = {"pinhole": "PINHOLE", "brown5": "OPENCV5", "brown8": "OPENCV8"}[camera.model]
    values = (camera.fx, camera.fy, camera.cx, camera.cy, *camera.distortion)
    lines = [
        "{",
        f"    'lensmodel':  'LENSMODEL_{name}',",
        "",
        "    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....",
        f"    'intrinsics': [ {', '.join(map(number_text, values))},],",
        "",
        # The name up to mrcal 2.4, which later versions still read.
        "    'extrinsics': [ 0, 0, 0, 0, 0, 0,],",
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
