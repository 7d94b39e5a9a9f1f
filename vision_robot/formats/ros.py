"""ROS camera_info YAML (camera_calibration_parsers), and the text of a CameraInfo message.

Models plumb_bob, rational_polynomial and equidistant. Rectification is written as identity and
the projection matrix as [K 0], as for a single camera; on reading both are left aside, as are
the camera's name and the caption of the topic. Skew: image_geometry reads only fx, fy, cx, cy.
"""

import re

from vision_robot.formats.camera_format import ALL_LENSES, CameraFormat
from vision_robot.formats.intrinsics import affine_from_matrix, brown_lens, make_camera
from vision_robot.formats.number import number_text
from vision_robot.formats.parse import parse_yaml
from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree
from vision_robot.geometry import Camera

__all__ = ["FORMAT"]

MODELS = {
    "plumb_bob": (0, 4, 5),
    "rational_polynomial": (0, 8, 12, 14),
    "equidistant": (4,),
}
"""Name -> how many coefficients it may have."""

NAMES = {
    "pinhole": "plumb_bob",
    "brown5": "plumb_bob",
    "brown8": "rational_polynomial",
    "fisheye": "equidistant",
}


def matches(source: CameraSource) -> bool:
    """Keys that only ROS writes."""
    pattern = rb"(?m)^(rectification_matrix|projection_matrix|distortion_model)\s*:"
    return re.search(pattern, source.data) is not None


def read(source: CameraSource) -> dict[str, Camera]:
    """The camera under its camera_name."""
    tree = parse_yaml(source)
    affine = affine_from_matrix(_data(tree.get("camera_matrix", "K")))
    for key in ("binning_x", "binning_y"):
        binning = tree.find(key)
        if binning is not None and binning.whole() > 1:
            raise binning.bad("binned pictures are not supported: 0 or 1 expected")
    model = tree.find("distortion_model")
    if model is None and tree.find("projection_matrix", "P") is None:
        raise source.bad("distortion_model and projection_matrix are missing: this is no ROS file")
    # camera_calibration_parsers itself takes a missing model for plumb_bob.
    kind = model.text() if model is not None else "plumb_bob"
    if kind not in MODELS:
        raise tree.bad(f"distortion_model is {kind!r}: one of {', '.join(MODELS)} expected")
    coefficients = _data(tree.get("distortion_coefficients", "D"))
    k = coefficients.numbers(*MODELS[kind])
    size = (tree.get("image_width", "width").whole(), tree.get("image_height", "height").whole())
    lens = ("fisheye", tuple(k)) if kind == "equidistant" else brown_lens(coefficients)
    return {"camera": make_camera(source, size, affine, *lens)}


def _data(matrix: Tree) -> Tree:
    return matrix.get("data") if isinstance(matrix.value, dict) else matrix


def write(camera: Camera, suffix: str) -> bytes:  # noqa: ARG001
    """YAML as camera_calibration_parsers writes it."""
    K = [number_text(value) for value in camera.K.ravel()]
    k = [number_text(value) for value in camera.distortion or (0.0,) * 5]
    zero, one = "0.0", "1.0"
    projection = [*K[:3], zero, *K[3:6], zero, *K[6:], zero]
    identity = [one, zero, zero, zero, one, zero, zero, zero, one]
    lines = [
        f"image_width: {camera.width}",
        f"image_height: {camera.height}",
        "camera_name: camera",
        *_matrix("camera_matrix", 3, 3, K),
        f"distortion_model: {NAMES[camera.model]}",
        *_matrix("distortion_coefficients", 1, len(k), k),
        *_matrix("rectification_matrix", 3, 3, identity),
        *_matrix("projection_matrix", 3, 4, projection),
    ]
    return ("\n".join(lines) + "\n").encode()


def _matrix(name: str, rows: int, cols: int, data: list[str]) -> list[str]:
    return [f"{name}:", f"  rows: {rows}", f"  cols: {cols}", f"  data: [{', '.join(data)}]"]


FORMAT = CameraFormat("ROS camera_info YAML", matches, read, write, ALL_LENSES)
