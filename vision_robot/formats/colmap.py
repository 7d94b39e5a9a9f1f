"""COLMAP's cameras.txt: one line a camera, ``CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]``.

COLMAP puts (0.5, 0.5) at the centre of the first pixel; ours is (0, 0), so its principal point
is ours + 0.5. Brown lenses without k3 are written as OPENCV, with it as FULL_OPENCV; a
FULL_OPENCV whose k4, k5, k6 are zero reads as brown5, which is the same lens.
"""

import re

from vision_robot.formats.camera_format import ALL_LENSES, CameraFormat
from vision_robot.formats.intrinsics import make_camera
from vision_robot.formats.number import number_text, shifted
from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree
from vision_robot.geometry import Camera

__all__ = ["FORMAT"]

MODELS = {
    "SIMPLE_PINHOLE": ("pinhole", "f cx cy"),
    "PINHOLE": ("pinhole", "fx fy cx cy"),
    "SIMPLE_RADIAL": ("brown5", "f cx cy k1"),
    "RADIAL": ("brown5", "f cx cy k1 k2"),
    "OPENCV": ("brown5", "fx fy cx cy k1 k2 p1 p2"),
    "OPENCV_FISHEYE": ("fisheye", "fx fy cx cy k1 k2 k3 k4"),
    "FULL_OPENCV": ("brown8", "fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6"),
}
"""COLMAP's name -> our lens, and its parameters in order."""

_LINE = re.compile(rb"(?m)^[ \t]*\d+[ \t]+[A-Z][A-Z_]+[ \t]+\d+[ \t]+\d+[ \t]")


def matches(source: CameraSource) -> bool:
    """COLMAP's heading, or a line of its form."""
    return b"# Camera list with one line" in source.data or _LINE.search(source.data) is not None


def read(source: CameraSource) -> dict[str, Camera]:
    """All cameras, each under its id."""
    cameras: dict[str, Camera] = {}
    for number, line in enumerate(source.text.split("\n"), start=1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        where = f"line {number}"
        if len(words) < 5:
            raise source.bad(f"{where}: CAMERA_ID MODEL WIDTH HEIGHT PARAMS[] expected")
        if words[0] in cameras:
            raise source.bad(f"{where}: camera {words[0]} is there twice")
        cameras[words[0]] = _read_one(source, where, words)
    if not cameras:
        raise source.bad("no line CAMERA_ID MODEL WIDTH HEIGHT PARAMS[] found")
    return cameras


def _read_one(source: CameraSource, where: str, words: list[str]) -> Camera:
    name = words[1]
    if name not in MODELS:
        raise source.bad(f"{where}: model {name} is not supported: one of {', '.join(MODELS)} expected")
    model, order = MODELS[name]
    parameters = order.split()
    texts = Tree(source, words[4:], f"{where}: {name}").number_texts(len(parameters))
    values = dict(zip(parameters, texts, strict=True))
    size = Tree(source, words[2], f"{where}: WIDTH"), Tree(source, words[3], f"{where}: HEIGHT")
    fx, fy = values.get("fx", values.get("f", "")), values.get("fy", values.get("f", ""))
    cx, cy = shifted(values["cx"], "-0.5"), shifted(values["cy"], "-0.5")
    k = {key: float(text) for key, text in values.items() if key[0] in "kp"}
    if model == "brown8" and not (k["k4"] or k["k5"] or k["k6"]):
        model = "brown5"
    coefficients = [k.get(key, 0.0) for key in ALL_LENSES[model]]
    affine = (float(fx), float(fy), float(cx), float(cy), 0.0)
    return make_camera(source, (size[0].whole(), size[1].whole()), affine, model, coefficients)


def write(camera: Camera, suffix: str) -> bytes:  # noqa: ARG001
    """One camera, with id 1."""
    values = dict(zip(camera.lens.coefficient_names, camera.distortion, strict=True))
    name = {"pinhole": "PINHOLE", "fisheye": "OPENCV_FISHEYE", "brown8": "FULL_OPENCV"}.get(camera.model)
    name = name or ("FULL_OPENCV" if values["k3"] else "OPENCV")
    texts = {key: number_text(value) for key, value in values.items()}
    texts |= {"fx": number_text(camera.fx), "fy": number_text(camera.fy)}
    texts |= {"cx": shifted(repr(camera.cx), "0.5"), "cy": shifted(repr(camera.cy), "0.5")}
    parameters = " ".join(texts.get(key, "0.0") for key in MODELS[name][1].split())
    lines = [
        "# Camera list with one line of data per camera:",
        "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]",
        "# Number of cameras: 1",
        f"1 {name} {camera.width} {camera.height} {parameters}",
    ]
    return ("\n".join(lines) + "\n").encode()


FORMAT = CameraFormat("COLMAP cameras.txt", matches, read, write, ALL_LENSES)
