"""`vr ik export` writes C, says what it costs, and refuses in one line what it cannot do."""

import json

import pytest
import typer
from typer.testing import CliRunner

from vision_robot.errors import BadArm, BadParameter, UnknownStructure
from vision_robot_cli.ik_export import ik_export

app = typer.Typer()
app.command("export")(ik_export)


def run(*words: object):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_it_tells_files_sizes_and_cycles(tmp_path):
    result = run("column", "-o", tmp_path / "c")
    assert result.exit_code == 0
    first, second, *_, last = result.stdout.splitlines()
    assert first.startswith(f"{tmp_path / 'c'}: 12 files; closed form (column, two upright axes")
    assert "code" in second
    assert "Cortex-M4F" in second
    assert ("measured with arm-none-eabi-gcc" in second) != ("(estimated)" in second)
    assert last == f"try it: make -C {tmp_path / 'c'} test"
    assert (tmp_path / "c/vr_ik.c").is_file()


def test_json_of_the_numeric_method(tmp_path):
    result = run("column", "-o", tmp_path, "--method", "numeric", "--precision", "double", "--json")
    told = json.loads(result.stdout)
    assert told["schema"] == "vr.ik.export/1"
    assert (told["method"], told["precision"], told["structure"]) == ("numeric", "double", None)
    assert told["starts"]["reached"] > 0.99 * told["starts"]["goals"]
    assert told["cycles_most_estimate"] > told["cycles_estimate"] > 100_000
    assert sorted(path.name for path in tmp_path.iterdir() if path.suffix not in (".o", ".su")) == sorted(
        told["files"]
    )


def test_limits_from_the_command_line_are_in_the_code(tmp_path):
    run("column", "-o", tmp_path, "--limit", "theta2=-90..90deg", "--limit", "d1=50..300mm")
    header = (tmp_path / "vr_arm.h").read_text()
    assert "(-90 ... 90 deg)" in header
    assert "slides  0.05 ... 0.3 m" in header


@pytest.mark.parametrize(
    ("words", "error", "says"),
    [
        (["column", "--precision", "half"], BadParameter, "single or double"),
        (["column", "--task", "look"], BadParameter, "pose, axis, tilt, position"),
        (["column", "--limit", "theta2=1..2"], BadParameter, "with m, mm, rad or deg"),
        (["column", "--limit", "theta2=2..1rad"], BadParameter, "first value is the lesser"),
        (["column", "--limit", "theta9=1..2rad"], BadParameter, "one of d1"),
        (["none.xml"], BadArm, "no such file"),
    ],
)
def test_bad_words_are_refused(tmp_path, words, error, says):
    result = run(*words, "-o", tmp_path / "c")
    assert isinstance(result.exception, error)
    assert says in str(result.exception)
    assert not (tmp_path / "c").exists()


def test_an_unknown_structure_has_no_closed_form(tmp_path):
    urdf = tmp_path / "arm.urdf"
    joint = """<joint name="j{0}" type="revolute"><parent link="l{0}"/><child link="l{1}"/>
        <origin xyz="0.1 0.02 0.2" rpy="0.3 0.4 0.5"/><axis xyz="0 0 1"/>
        <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>"""
    links = "".join(f'<link name="l{i}"/>' for i in range(7))
    urdf.write_text(f'<robot name="odd">{links}{"".join(joint.format(i, i + 1) for i in range(6))}</robot>')
    result = run(urdf, "-o", tmp_path / "c", "--method", "closed-form")
    assert isinstance(result.exception, UnknownStructure)
    assert (
        run(urdf, "-o", tmp_path / "c")
        .stdout.splitlines()[0]
        .startswith(f"{tmp_path / 'c'}: 12 files; damped steps")
    )
