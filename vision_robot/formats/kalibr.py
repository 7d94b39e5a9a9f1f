"""Kalibr's camchain YAML: cam0, cam1, ...

camera_model pinhole with distortion_model none, radtan (k1 k2 p1 p2: brown5 with k3 = 0) or
equidistant; omni, ds, eucm and fov are refused by name. Poses between the cameras are left
aside.
"""

import re

from vision_robot.formats.camera_format import CameraFormat
from vision_robot.formats.intrinsics import make_camera
from vision_robot.formats.number import number_text
from vision_robot.formats.parse import parse_yaml
from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree
from vision_robot.geometry import Camera

__all__ = ["FORMAT"]

LENSES = {"none": "pinhole", "radtan": "brown5", "equidistant": "fisheye"}
COUNTS = {"none": 0, "radtan": 4, "equidistant": 4}


def matches(source: CameraSource) -> bool:
    """A cam0 at the top, or Kalibr's key for the coefficients."""
    pattern = rb"(?m)^(cam\d+\s*:|[ \t]+distortion_coeffs\s*:)"
    return re.search(pattern, source.data) is not None


def read(source: CameraSource) -> dict[str, Camera]:
    """All cameras of the chain."""
    tree = parse_yaml(source)
    names = [name for name in tree.names() if re.fullmatch(r"cam\d+", name)]
    if not names:
        raise source.bad("cam0 is missing")
    return {name: _read_one(source, tree.get(name)) for name in names}


def _read_one(source: CameraSource, cam: Tree) -> Camera:
    model = cam.get("camera_model")
    if model.text() != "pinhole":
        raise model.bad(f"{model.text()!r} is not supported: pinhole expected")
    kind = cam.get("distortion_model")
    if kind.text() not in LENSES:
        raise kind.bad(f"{kind.text()!r} is not supported: one of {', '.join(LENSES)} expected")
    fx, fy, cx, cy = cam.get("intrinsics").numbers(4)
    k = cam.get("distortion_coeffs").numbers(COUNTS[kind.text()]) if kind.text() != "none" else []
    lens = LENSES[kind.text()]
    k = [*k, 0.0] if lens == "brown5" else k
    return make_camera(source, cam.get("resolution").pair(), (fx, fy, cx, cy, 0.0), lens, k)


def write(camera: Camera, suffix: str) -> bytes:  # noqa: ARG001
    """A chain of one camera, cam0."""
    kind = next(kind for kind, model in LENSES.items() if model == camera.model)
    affine = ", ".join(map(number_text, (camera.fx, camera.fy, camera.cx, camera.cy)))
    k = ", ".join(map(number_text, camera.distortion[: COUNTS[kind]]))
    lines = [
        "cam0:",
        "  camera_model: pinhole",
        f"  intrinsics: [{affine}]",
        f"  distortion_model: {kind}",
        f"  distortion_coeffs: [{k}]",
        "  cam_overlaps: []",
        "  rostopic: /cam0/image_raw",
        f"  resolution: [{camera.width}, {camera.height}]",
    ]
    return ("\n".join(lines) + "\n").encode()


FORMAT = CameraFormat(
    title="Kalibr camchain YAML",
    matches=matches,
    read=read,
    write=write,
    lenses={"pinhole": (), "brown5": ("k1", "k2", "p1", "p2"), "fisheye": ("k1", "k2", "k3", "k4")},
)
