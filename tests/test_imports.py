"""Proves that imports point one way, the library is silent, and nobody imports MuJoCo past the door."""

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from vision_robot import PUBLIC

ROOT = Path(__file__).parents[1]
SOURCES = [ROOT / "vision_robot", ROOT / "datasets_synth/vision_robot_synth", ROOT / "cli/vision_robot_cli"]

# Each room may import those before it; rooms of one line may import each other as long as no circle closes.
LAYERS = (
    ("types", "errors", "files", "reading"),
    ("geometry",),
    (
        "formats",
        "calibrate",
        "extrinsics",
        "flow",
        "arm",
        "sim",
        "images",
        "video",
        "bag",
        "tracks",
        "dataset",
        "flatten",
    ),
    ("track", "pick", "machine"),
    ("evaluate",),
    ("report",),
    ("vision_robot_synth",),
    ("vision_robot_cli",),
)
LAYER = {room: k for k, rooms in enumerate(LAYERS) for room in rooms}


def modules() -> list[Path]:
    """All source files but the library's public face, which may re-export from any room."""
    files = [path for source in SOURCES for path in sorted(source.rglob("*.py"))]
    return [path for path in files if path != ROOT / "vision_robot/__init__.py"]


def dotted(path: Path) -> list[str]:
    source = next(source for source in SOURCES if path.is_relative_to(source))
    return [source.name, *path.relative_to(source).with_suffix("").parts]


def room_of(name: list[str]) -> str:
    """The room of a dotted name: below vision_robot the second word, else the first."""
    if name[0] != "vision_robot":
        return name[0]
    return room_of(PUBLIC[name[1]].split(".")) if name[1] in PUBLIC else name[1]


def imports(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Line and dotted name of every import, those inside functions and TYPE_CHECKING included."""
    here = dotted(path)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name.split(".")) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = here[: -node.level] if node.level else []
            words = [*base, *(node.module or "").split(".")]
            for alias in node.names:
                yield node.lineno, [*(word for word in words if word), alias.name]


def ours() -> Iterator[tuple[Path, int, str, str]]:
    """File, line, importing room and imported room of every import of our own packages."""
    packages = {source.name for source in SOURCES}
    for path in modules():
        for line, name in imports(path):
            if name[0] in packages and name[1:] not in ([], ["__version__"], ["MOST_PIXELS"]):
                yield path, line, room_of(dotted(path)), room_of(name)


def test_every_room_has_its_place():
    rooms = {room_of(dotted(path)) for path in modules()}
    assert rooms <= set(LAYER), f"put {sorted(rooms - set(LAYER))} into LAYERS, and into ARCHITECTURE.md"


def test_imports_point_one_way():
    wrong = [
        f"{path.relative_to(ROOT)}:{line}: {room} must not import {other}"
        for path, line, room, other in ours()
        if LAYER.get(other, len(LAYERS)) > LAYER.get(room, len(LAYERS))
    ]
    assert not wrong, "\n".join(["imports that point the wrong way:", *wrong])


def test_no_two_rooms_need_each_other():
    needs: dict[str, set[str]] = {}
    for _, _, room, other in ours():
        if other != room:
            needs.setdefault(room, set()).add(other)
    try:
        TopologicalSorter(needs).prepare()
    except CycleError as circle:
        pytest.fail(f"rooms import each other in a circle: {' -> '.join(circle.args[1])}")


def test_the_library_neither_prints_nor_exits():
    wrong = []
    for path in modules():
        if not path.is_relative_to(ROOT / "vision_robot"):
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) in (
                "print",
                "exit",
                "sys.exit",
                "input",
            ):
                wrong.append(f"{path.relative_to(ROOT)}:{node.lineno}: {ast.unparse(node.func)}")
    assert not wrong, "\n".join(["the library computes and returns:", *wrong])


def test_mujoco_is_imported_through_its_door():
    """`import mujoco` obeys MUJOCO_GL and may raise AttributeError; load_mujoco does not."""
    wrong = []
    for path in modules():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for_types = {
            id(inner)
            for node in ast.walk(tree)
            if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
            for inner in ast.walk(node)
        }
        for node in ast.walk(tree):
            if not isinstance(node, ast.Import | ast.ImportFrom) or id(node) in for_types:
                continue
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            if any(name.split(".")[0] == "mujoco" for name in names):
                wrong.append(f"{path.relative_to(ROOT)}:{node.lineno}")
    assert not wrong, "\n".join(["take mujoco from vision_robot.sim.gl.load_mujoco:", *wrong])


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("import vision_robot.report", ["vision_robot", "report"]),
        ("def f():\n    from vision_robot.report import page", ["vision_robot", "report", "page"]),
        ("from ..report import page", ["vision_robot", "report", "page"]),
        ("from . import other", ["vision_robot", "geometry", "other"]),
    ],
)
def test_the_walk_itself_sees(tmp_path, monkeypatch, text, found):
    """An import written in any way is found: else the tests above would prove nothing."""
    room = tmp_path / "vision_robot/geometry"
    room.mkdir(parents=True)
    (room / "se3.py").write_text(text)
    monkeypatch.setattr(f"{__name__}.SOURCES", [tmp_path / "vision_robot"])
    assert [name for _, name in imports(room / "se3.py")] == [found]
