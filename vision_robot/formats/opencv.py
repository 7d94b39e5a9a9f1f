"""OpenCV's FileStorage: YAML, JSON and XML.

Keys as OpenCV's calibration sample writes them: image_width, image_height, camera_matrix,
distortion_coefficients and fisheye_model; the spellings of its other samples are read too
(stereo pairs as cameras 1 and 2). Read without cv2.

Skew: OpenCV's functions read fx, fy, cx, cy from the matrix and ignore its entry (0, 1). A
file that has one is read with it; writing one would let it vanish in silence at the reader, so
that needs `allow_loss`.
"""

import json
import re

from vision_robot.errors import BadCameraFile
from vision_robot.formats.camera_format import ALL_LENSES, CameraFormat
from vision_robot.formats.intrinsics import affine_from_matrix, brown_lens, make_camera
from vision_robot.formats.number import number_text
from vision_robot.formats.parse import parse_yaml
from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree
from vision_robot.geometry import Camera
from vision_robot.reading import xml_root

__all__ = ["FORMAT"]

MATRIX_KEYS = (
    ("camera", "camera_matrix", ("distortion_coefficients", "dist_coeffs", "dist_coeff", "dist")),
    ("camera", "mtx", ("dist", "dist_coeffs")),
    ("camera", "K", ("D", "dist_coeffs", "dist")),
    ("1", "M1", ("D1",)),
    ("1", "K1", ("D1",)),
    ("2", "M2", ("D2",)),
    ("2", "K2", ("D2",)),
)
"""(name of the camera, key of its matrix, keys of its coefficients)."""


def matches(source: CameraSource) -> bool:
    """OpenCV's marks, or its keys without those of ROS."""
    data = source.data
    if re.search(rb"distortion_model|rectification_matrix|projection_matrix", data):
        return False
    return re.search(rb"opencv-matrix|opencv_storage|\A%YAML:1|(?i:camera_?matrix)", data) is not None


def read(source: CameraSource) -> dict[str, Camera]:
    """All matrices that are named as a camera's."""
    # OpenCV's JSON holds .Nan and, before version 5, 1. for 1.0: no JSON, but YAML.
    tree = _parse_xml(source) if source.text.lstrip().startswith("<") else parse_yaml(source)
    if tree.find("distortion_model") is not None:
        raise source.bad("distortion_model is a key of ROS, not of OpenCV: read it as ros")
    cameras = {}
    for name, matrix, coefficients in MATRIX_KEYS:
        K = tree.find(matrix)
        if K is not None and name not in cameras:
            cameras[name] = _read_one(source, tree, K, tree.get(*coefficients))
    if not cameras:
        raise source.bad("camera_matrix is missing")
    return cameras


def _read_one(source: CameraSource, tree: Tree, K: Tree, D: Tree) -> Camera:
    affine = affine_from_matrix(_data(K))
    fisheye = tree.find("fisheye_model")
    if fisheye is not None and fisheye.whole() != 0:
        return make_camera(source, _size(tree), affine, "fisheye", _data(D).numbers(4))
    return make_camera(source, _size(tree), affine, *brown_lens(_data(D)))


def _size(tree: Tree) -> tuple[int, int] | None:
    width, height, both = tree.find("image_width"), tree.find("image_height"), tree.find("image_size")
    if width is not None or height is not None:
        return tree.get("image_width").whole(), tree.get("image_height").whole()
    if both is not None:
        return both.pair()
    return None


def _data(matrix: Tree) -> Tree:
    """The numbers of a stored matrix, whose count must be rows x cols."""
    if not isinstance(matrix.value, dict):
        return matrix
    data = matrix.get("data")
    rows, cols = matrix.get("rows").whole(), matrix.get("cols").whole()
    data.number_texts(rows * cols)
    return data


def _parse_xml(source: CameraSource) -> Tree:
    """FileStorage XML as a tree of the same form as its YAML."""
    # The declaration's encoding is no longer true of decoded text.
    root = xml_root(re.sub(r"\A\s*<\?xml[^>]*\?>", "", source.text), source.path, BadCameraFile)
    tree: dict[str, object] = {}
    for element in root:
        fields = {child.tag: (child.text or "").strip() for child in element}
        text = (element.text or "").strip()
        if "data" in fields:
            tree[element.tag] = {**fields, "data": fields["data"].split()}
        elif not fields:
            tree[element.tag] = text.split() if len(text.split()) > 1 else text
    return Tree(source, tree)


def write(camera: Camera, suffix: str) -> bytes:
    """YAML, JSON or XML by the suffix; YAML is what any version of OpenCV reads."""
    # Five zeros rather than no coefficients: not every reader takes an empty matrix.
    k = [number_text(value) for value in camera.distortion or (0.0,) * 5]
    K = [number_text(value) for value in camera.K.ravel()]
    numbers = {
        "image_width": camera.width,
        "image_height": camera.height,
        "fisheye_model": int(camera.model == "fisheye"),
    }
    matrices = {"camera_matrix": (3, 3, K), "distortion_coefficients": (1, len(k), k)}
    render = {".json": _json, ".xml": _xml}.get(suffix, _yaml)
    return render(numbers, matrices).encode()


Matrices = dict[str, tuple[int, int, list[str]]]


def _yaml(numbers: dict[str, int], matrices: Matrices) -> str:
    lines = ["%YAML 1.1", "---", *(f"{key}: {value}" for key, value in numbers.items())]
    for key, (rows, cols, data) in matrices.items():
        lines += [f"{key}: !!opencv-matrix", f"   rows: {rows}", f"   cols: {cols}", "   dt: d"]
        lines += [f"   data: [ {', '.join(data)} ]"]
    return "\n".join(lines) + "\n"


def _json(numbers: dict[str, int], matrices: Matrices) -> str:
    tree: dict[str, object] = dict(numbers)
    for key, (rows, cols, data) in matrices.items():
        values = [float(text) for text in data]
        tree[key] = {"type_id": "opencv-matrix", "rows": rows, "cols": cols, "dt": "d", "data": values}
    return json.dumps(tree, indent=4) + "\n"


def _xml(numbers: dict[str, int], matrices: Matrices) -> str:
    lines = ['<?xml version="1.0"?>', "<opencv_storage>"]
    lines += [f"<{key}>{value}</{key}>" for key, value in numbers.items()]
    for key, (rows, cols, data) in matrices.items():
        lines += [f'<{key} type_id="opencv-matrix">', f"  <rows>{rows}</rows>", f"  <cols>{cols}</cols>"]
        lines += ["  <dt>d</dt>", "  <data>", f"    {' '.join(data)}</data></{key}>"]
    return "\n".join([*lines, "</opencv_storage>", ""])


FORMAT = CameraFormat("OpenCV FileStorage (YAML, JSON, XML)", matches, read, write, ALL_LENSES)
