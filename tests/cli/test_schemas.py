"""Proves that every command's `--json` has a published schema, that schemas are sound, and `vr schema`."""

import ast
import json
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from tests.cli.json_schemas import faults
from vision_robot.errors import BadParameter
from vision_robot.formats import write_camera
from vision_robot.geometry import Camera
from vision_robot_cli.main import run
from vision_robot_cli.schemas import schema_named, schema_names

CLI = Path(__file__).parents[2] / "cli/vision_robot_cli"
FILES = {"camera", "hand-eye"}
"""Of files only; those of planes, rigs and tools have the names of the commands that print them."""


def emitted() -> set[str]:
    """Names in the calls of emit_json, over all commands."""
    found = set()
    for path in CLI.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "emit_json":
                assert isinstance(node.args[0], ast.Constant)
                found.add(node.args[0].value)
    return found


def test_every_output_has_a_schema_and_every_schema_an_output():
    assert emitted() | FILES == set(schema_names())


@pytest.mark.parametrize("name", schema_names())
def test_schemas_are_sound_and_stand_alone(name):
    schema = schema_named(name)
    Draft202012Validator.check_schema(schema)
    told = schema.get("properties") or schema["anyOf"][0]["properties"]
    assert told["schema"] == {"const": f"vr.{name}/1"}
    assert schema["$id"] == f"urn:vision-robot:{name}:1"
    text = json.dumps(schema)
    for part in text.split('"$ref": "')[1:]:
        place = part.partition('"')[0].removeprefix("#/$defs/")
        assert place in schema["$defs"]


def test_validation_can_fail():
    good = {"schema": "vr.convert/1", "in": ["a"], "out": ["b"], "cameras": [], "read_back_shift_px": 0.0}
    good["covariance"] = True
    assert faults(good) == []
    (missing,) = faults({key: value for key, value in good.items() if key != "out"})
    assert "'out' is a required property" in missing
    (more,) = faults(good | {"further": 1})
    assert "'further' was unexpected" in more
    (wrong,) = faults(good | {"read_back_shift_px": "0"})
    assert "$.read_back_shift_px" in wrong


def test_camera_files_keep_theirs(tmp_path):
    write_camera(Camera(640, 480, 500, 500, 319.5, 239.5), tmp_path / "camera.json")
    assert faults(json.loads((tmp_path / "camera.json").read_text())) == []


def test_the_command_lists_and_shows(capsys):
    assert run(["schema"]) == 0
    assert "calibrate" in capsys.readouterr().out
    assert run(["schema", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert [row["name"] for row in listed["schemas"]] == schema_names()
    for name in ("calibrate", "vr.calibrate/1"):
        assert run(["schema", name]) == 0
        assert json.loads(capsys.readouterr().out) == schema_named("calibrate")
    assert run(["schema", "bogus"]) == 2
    assert "it must be one of benchmark, board" in capsys.readouterr().err


def test_the_library_says_so_too():
    with pytest.raises(BadParameter, match="one of benchmark"):
        schema_named("")
