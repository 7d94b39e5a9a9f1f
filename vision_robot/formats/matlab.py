"""MATLAB's camera calibrator: `toStruct(cameraParams)` as JSON, as text or as a .mat file.

Two conventions differ from ours (MathWorks, cameraIntrinsicsToOpenCV):
row vectors: IntrinsicMatrix is the transpose of K, [fx 0 0; s fy 0; cx cy 1] (the newer property K
is not transposed); and pixels: the centre of the first pixel is (1, 1), so that a principal
point is ours + 1. ImageSize is [rows columns]. Coefficients are OpenCV's k1 k2 [k3] and p1 p2.

Text is any lines ``Name = [1 2; 3 4]`` (a .m script) or ``Name: [1 2]`` (what MATLAB prints).
"""

import re

from vision_robot.formats.camera_format import ALL_LENSES, CameraFormat
from vision_robot.formats.intrinsics import affine_from_matrix, make_camera
from vision_robot.formats.matfile import is_matfile, parse_matfile, write_matfile
from vision_robot.formats.number import number_text, shifted
from vision_robot.formats.parse import parse_json
from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree
from vision_robot.geometry import Camera

__all__ = ["FORMAT"]

NAMES = (
    "IntrinsicMatrix",
    "K",
    "FocalLength",
    "PrincipalPoint",
    "Skew",
    "RadialDistortion",
    "TangentialDistortion",
    "ImageSize",
)

_ASSIGNMENT = re.compile(
    rf"(?m)^[ \t]*(?:\w+\.)*({'|'.join(NAMES)})[ \t]*[=:][ \t]*(?:\[([^\]=\[]*)\]|([^\s;%\[][^\n;%]*))"
)


def matches(source: CameraSource) -> bool:
    """A MAT-file, or MATLAB's names of properties."""
    if is_matfile(source):
        return True
    return re.search(rb"IntrinsicMatrix|RadialDistortion|PrincipalPoint", source.data) is not None


def read(source: CameraSource) -> dict[str, Camera]:
    """The camera, in our conventions."""
    if is_matfile(source):
        tree = _struct(parse_matfile(source))
    elif source.text.lstrip().startswith("{"):
        tree = _struct(parse_json(source))
    else:
        tree = _parse_text(source)
    fx, fy, cx, cy, skew = _affine(tree)
    radial, tangential = tree.find("RadialDistortion"), tree.find("TangentialDistortion")
    k = radial.numbers(2, 3) if radial else [0.0, 0.0]
    p = tangential.numbers(2) if tangential else [0.0, 0.0]
    size = tree.find("ImageSize")
    # cameraParameters made without pictures holds an empty ImageSize.
    rows, columns = size.pair() if size and size.numbers(0, 2) else (None, None)
    coefficients = (k[0], k[1], p[0], p[1], k[2] if len(k) == 3 else 0.0)
    lens = ("brown5", coefficients) if any(coefficients) else ("pinhole", ())
    shape = (columns, rows) if rows and columns else None
    return {"camera": make_camera(source, shape, (fx, fy, cx, cy, skew), *lens)}


def _affine(tree: Tree) -> tuple[float, float, float, float, float]:
    transposed, K = tree.find("IntrinsicMatrix"), tree.find("K")
    if transposed is not None:
        t = transposed.number_texts(9)
        if float(t[2]) or float(t[5]):
            raise transposed.bad("the row-vector form [fx 0 0; s fy 0; cx cy 1] expected: K is its transpose")
        columns = [t[0], t[3], t[6], t[1], t[4], t[7], t[2], t[5], t[8]]
        return _zero_based(Tree(tree.source, columns, transposed.key))
    if K is not None:
        return _zero_based(Tree(tree.source, K.number_texts(9), K.key))
    f, c = tree.get("FocalLength").number_texts(2), tree.get("PrincipalPoint").number_texts(2)
    skew = tree.find("Skew")
    s = skew.number_text() if skew is not None else "0"
    return _zero_based(Tree(tree.source, [f[0], s, c[0], "0", f[1], c[1], "0", "0", "1"], "PrincipalPoint"))


def _zero_based(K: Tree) -> tuple[float, float, float, float, float]:
    t = K.number_texts(9)
    t[2], t[5] = shifted(t[2], "-1"), shifted(t[5], "-1")
    return affine_from_matrix(Tree(K.source, t, K.key))


def _struct(top: Tree) -> Tree:
    """The struct with the intrinsics: the top itself, a field of it, or a field of that one."""
    level = [top]
    for _ in range(3):
        for tree in level:
            if any(tree.find(name) for name in ("IntrinsicMatrix", "K", "FocalLength")):
                return tree
        fields = [tree.get(name) for tree in level for name in tree.names()]
        level = [field for field in fields if isinstance(field.value, dict)]
    raise top.bad("IntrinsicMatrix is missing; for a .mat, save toStruct(cameraParams) with -struct")


def _parse_text(source: CameraSource) -> Tree:
    fields: dict[str, object] = {}
    for name, matrix, scalar in _ASSIGNMENT.findall(source.text):
        fields[name] = scalar.strip() if scalar else re.sub(r"[,;\n]|\.{3}", " ", matrix).split()
    return Tree(source, fields)


def write(camera: Camera, suffix: str) -> bytes:
    """A .mat by that suffix, JSON by .json, otherwise a script of assignments."""
    cx, cy = shifted(repr(camera.cx), "1"), shifted(repr(camera.cy), "1")
    fx, fy, s = map(number_text, (camera.fx, camera.fy, camera.skew))
    k1, k2, p1, p2, k3 = map(number_text, camera.distortion or (0.0,) * 5)
    fields = {
        "IntrinsicMatrix": [[fx, "0", "0"], [s, fy, "0"], [cx, cy, "1"]],
        "FocalLength": [[fx, fy]],
        "PrincipalPoint": [[cx, cy]],
        "Skew": [[s]],
        "RadialDistortion": [[k1, k2, k3]],
        "TangentialDistortion": [[p1, p2]],
        "ImageSize": [[str(camera.height), str(camera.width)]],
    }
    if suffix == ".mat":
        return write_matfile(fields)
    if suffix == ".json":
        return _json(fields).encode()
    lines = [f"{name} = [{'; '.join(' '.join(row) for row in rows)}];" for name, rows in fields.items()]
    return ("\n".join(["% MATLAB: row vectors, pixels from 1", *lines]) + "\n").encode()


def _json(fields: dict[str, list[list[str]]]) -> str:
    """JSON as MATLAB's jsonencode lays out: a row vector as a list, a scalar as itself.

    Written by hand because the json module would round our exact decimals.
    """
    lines = []
    for name, rows in fields.items():
        inner = [f"[{', '.join(row)}]" for row in rows]
        value = f"[{', '.join(inner)}]" if len(rows) > 1 else inner[0]
        lines.append(f'  "{name}": {rows[0][0] if rows == [rows[0][:1]] else value}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


FORMAT = CameraFormat(
    title="MATLAB camera parameters (JSON, text, .mat)",
    matches=matches,
    read=read,
    write=write,
    lenses={name: ALL_LENSES[name] for name in ("pinhole", "brown5")},
    skew=True,
)
