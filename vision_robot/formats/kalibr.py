"""Kalibr's camchain YAML: cam0, cam1, ...

camera_model pinhole with distortion_model none, radtan (k1 k2 p1 p2: brown5 with k3 = 0) or
equidistant; omni, ds, eucm and fov are refused by name. T_cn_cnm1 of a camera carries points from the
camera before it, so that a chain is a rig (`vision_robot.formats.rig`); for single cameras it is left aside.
"""

import re
from collections.abc import Sequence

from vision_robot.formats.camera_format import CameraFormat
from vision_robot.formats.intrinsics import make_camera
from vision_robot.formats.number import number_text
from vision_robot.formats.parse import parse_yaml
from vision_robot.formats.pose import read_matrix, stacked
from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree
from vision_robot.geometry import SE3, Camera

__all__ = ["FORMAT", "read_poses", "write_chain"]

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


def read_poses(source: CameraSource) -> SE3:
    """Each camera from the first, (cameras,); raises BadCameraFile where one of the links is missing."""
    tree = parse_yaml(source)
    names = [name for name in tree.names() if re.fullmatch(r"cam\d+", name)]
    poses = [SE3.identity()]
    for name in names[1:]:
        poses.append(read_matrix(tree.get(name).get("T_cn_cnm1")) @ poses[-1])
    return stacked(poses)


def write(camera: Camera, suffix: str) -> bytes:  # noqa: ARG001
    """A chain of one camera, cam0."""
    return write_chain([camera], SE3.identity(1))


def write_chain(cameras: Sequence[Camera], cam_from_rig: SE3) -> bytes:
    """cam0, cam1, ... with T_cn_cnm1; every camera is taken to see what the others see."""
    lines = []
    for i, camera in enumerate(cameras):
        kind = next(kind for kind, model in LENSES.items() if model == camera.model)
        affine = ", ".join(map(number_text, (camera.fx, camera.fy, camera.cx, camera.cy)))
        k = ", ".join(map(number_text, camera.distortion[: COUNTS[kind]]))
        others = ", ".join(str(j) for j in range(len(cameras)) if j != i)
        lines.append(f"cam{i}:")
        if i:
            lines.append("  T_cn_cnm1:")
            step = cam_from_rig[i] @ cam_from_rig[i - 1].inverse()
            lines += [f"  - [{', '.join(map(number_text, row))}]" for row in step.as_matrix().tolist()]
        lines += [
            "  camera_model: pinhole",
            f"  intrinsics: [{affine}]",
            f"  distortion_model: {kind}",
            f"  distortion_coeffs: [{k}]",
            f"  cam_overlaps: [{others}]",
            f"  rostopic: /cam{i}/image_raw",
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
