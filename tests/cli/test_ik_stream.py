"""`vr ik stream` plays a table over a pseudo-terminal to a receiver built from the exported C."""

import json
import subprocess

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from tests.arm.compiled import CompiledArm, column_arm, needs_gcc
from tests.arm.serial_line import Line
from vision_robot.arm.stream import JointTable
from vision_robot.errors import BadPort, BadTable, LinkMismatch
from vision_robot_cli.ik_stream import ik_stream

app = typer.Typer()
app.command("stream")(ik_stream)
CHAIN = column_arm().chain


def run(*words: object):
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.fixture
def table(tmp_path):
    share = np.linspace(0.3, 0.7, 6)[:, None]
    q = CHAIN.limits[:, 0] + share * np.diff(CHAIN.limits)[:, 0]
    path = tmp_path / "joints.csv"
    JointTable.of(CHAIN, 0.02 * np.arange(6), q).write(path)
    return path


@pytest.fixture(scope="module")
def firmware(tmp_path_factory):
    folder = tmp_path_factory.mktemp("firmware")
    CompiledArm(column_arm(), folder)
    subprocess.run(["make", "receiver"], cwd=folder, check=True, capture_output=True)
    return folder


@needs_gcc
def test_a_table_is_played_and_the_answers_written(tmp_path, table, firmware):
    line = Line(["./receiver"], firmware)
    words = ("--timeout", 2, "-o", tmp_path / "answers.csv", "--json")
    result = run(table, "--port", line.name, *words)
    moves = line.end()
    told = json.loads(result.stdout)
    assert told["schema"] == "vr.ik.stream/1"
    assert (told["rows"], told["carried_out"], told["resent"]) == (6, 6, 0)
    assert [time for time, _ in moves] == [0, 20, 40, 60, 80, 100]
    sent, answered = JointTable.read(table, CHAIN), JointTable.read(tmp_path / "answers.csv", CHAIN)
    assert np.allclose(answered.q, sent.q, atol=1e-6)
    assert np.allclose([q for _, q in moves], sent.q, atol=1e-6)


@needs_gcc
def test_another_arm_is_not_driven(table, firmware):
    line = Line(["./receiver"], firmware)
    result = run(table, "--port", line.name, "--limit", "d1=0..0.39m", "--timeout", 2)
    assert line.end() == []
    assert isinstance(result.exception, LinkMismatch)
    assert "fingerprint" in str(result.exception)


@needs_gcc
def test_poses_are_solved_by_the_receiver(tmp_path, firmware):
    """Places and yaws on a station go out; the joints that come back bring the tool there."""
    goals, station = tmp_path / "rods.csv", tmp_path / "station.csv"
    goals.write_text("time_s,x_mm,y_mm,z_mm,yaw_deg\n0,50,20,60,0\n0.03,60,20,60,10\n0.06,60,40,40,20\n")
    station.write_text("x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n0.3,0.1,0.05,0,0,0.2\n")
    line = Line(["./receiver"], firmware)
    words = ("--poses", "--station", station, "--timeout", 2, "-o", tmp_path / "q.csv")
    result = run(goals, *words, "--port", line.name)
    moves = line.end()
    assert result.exit_code == 0, result.exception
    assert [time for time, _ in moves] == [0, 30, 60]
    reached = CHAIN.base_from_tool(JointTable.read(tmp_path / "q.csv", CHAIN).q)
    c, s = np.cos(0.2), np.sin(0.2)
    on_station = np.array([[0.05, 0.02, 0.06], [0.06, 0.02, 0.06], [0.06, 0.04, 0.04]])
    wanted = on_station @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [0.3, 0.1, 0.05]
    assert np.abs(reached.translation - wanted).max() < 1e-5
    assert np.abs(reached.rotation[:, 2, 2] + 1).max() < 1e-6  # the tool points down


@pytest.mark.parametrize(
    ("text", "words", "says"),
    [
        ("x_mm,y_mm,z_mm,yaw_deg\n1,2,3,x\n", ["--poses"], "yaw_deg is 'x'"),
        ("time_s,x_mm,y_mm,z_mm,yaw_deg\n1,1,2,3,4\n1,1,2,3,4\n", ["--poses"], "time_s must rise"),
        ("x_mm,y_mm,z_mm,yaw_deg\n1,2,3,4\n", ["--poses", "--period", 0], "--period is 0"),
        ("x_mm,y_mm,z_mm,yaw_deg\n1,2,3,4\n", ["--station", "s.csv"], "together with --poses"),
        ("x_mm,y_mm,z_mm,yaw_deg\n1,2,3,4\n", [], "lacks the column time_s"),
    ],
)
def test_bad_goals_are_refused(tmp_path, text, words, says):
    path = tmp_path / "goals.csv"
    path.write_text(text)
    assert says in str(run(path, *words).exception)


def test_without_a_port_the_table_is_checked(table):
    assert run(table).stdout == f"{table}: 6 rows, all inside the limits, over 0.100 s\n"


@pytest.mark.parametrize(
    ("old", "new", "error", "says"),
    [
        ("d1_m", "d1", BadTable, "lacks d1_m or d1_mm"),
        ("0.04,", "0.01,", BadTable, "time_s must rise"),
        ("0.04,", "0.04,9", BadTable, "line 4: d1 is 90"),
    ],
)
def test_bad_tables_are_refused(table, old, new, error, says):
    table.write_text(table.read_text().replace(old, new, 1))
    result = run(table, "--port", "/dev/none")
    assert isinstance(result.exception, error)
    assert says in str(result.exception)


def test_a_missing_port_is_named(table):
    result = run(table, "--port", "/dev/none")
    assert isinstance(result.exception, BadPort)
