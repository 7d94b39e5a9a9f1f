"""`vr extrinsics hand-eye` as a person runs it: files, rendered sets, an arm that drives, every bad input."""

import json
from pathlib import Path

import numpy as np
import pytest

from vision_robot.formats import read_camera
from vision_robot.formats.hand_eye import read_hand_eye
from vision_robot_cli.main import run
from vision_robot_synth.hand_eye import hand_eye_set
from vision_robot_synth.hand_eye_folder import pose_table_csv, write_hand_eye_set
from vision_robot_synth.quaternions import quaternions

COMMAND = ("extrinsics", "hand-eye")


def run_json(capsys, *arguments) -> dict:
    assert run([*COMMAND, *map(str, arguments), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def refused(capsys, *arguments) -> str:
    """The one line that a bad input gets, with exit code 2 and nothing on stdout."""
    assert run([*COMMAND, *map(str, arguments)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    lines = captured.err.strip().splitlines()
    assert len(lines) == 1, lines
    return lines[0]


@pytest.fixture(scope="module")
def photos(tmp_path_factory) -> Path:
    """Eight pictures rendered from the arm, with its poses."""
    folder = tmp_path_factory.mktemp("set") / "photos"
    write_hand_eye_set(hand_eye_set(views=8, seed=4), folder)
    return folder


@pytest.fixture
def corner_set(tmp_path) -> tuple[str, ...]:
    """Corners and poses without pictures."""
    made = hand_eye_set(views=10, seed=2)
    (tmp_path / "corners").mkdir()
    for view in made.corners(0.2):
        np.savetxt(tmp_path / "corners" / f"{view.image.replace(' ', '_')}.txt", view.pixels)
    np.savetxt(tmp_path / "board.txt", made.board.points[:, :2])
    (tmp_path / "poses.csv").write_text(pose_table_csv(made).replace(".png", ".txt"))
    from vision_robot.formats import write_camera

    write_camera(made.camera, tmp_path / "camera.yaml")
    return (
        *("--corners", str(tmp_path / "corners"), "--model-points", str(tmp_path / "board.txt")),
        *("--poses", str(tmp_path / "poses.csv"), "--camera", str(tmp_path / "camera.yaml")),
    )


def files(photos: Path, *, poses: Path | None = None) -> tuple[str, ...]:
    table, camera = poses or photos / "poses.csv", photos / "camera.json"
    return (str(photos / "frames"), "--poses", str(table), "--camera", str(camera))


def test_photos_and_poses_give_the_truth(capsys, photos, tmp_path):
    found = run_json(capsys, *files(photos), "-o", tmp_path / "he.json", "--report", tmp_path / "page.html")
    assert found["schema"] == "vr.extrinsics.hand-eye/1"
    truth = read_hand_eye(photos / "truth.json")
    written = read_hand_eye(tmp_path / "he.json")
    off = written.mount_from_cam.translation - truth.mount_from_cam.translation
    half = [found["interval95"][f"{axis}_mm"] / 1e3 for axis in "xyz"]
    assert (np.abs(off) < 2.5 * np.array(half)).all()
    assert found["wrist_from_cam"]["translation_m"] == written.mount_from_cam.translation.tolist()
    assert found["views_used"] == 8
    assert found["dominant"] == "arm"
    assert found["held_out"]["found_over_foretold"] == pytest.approx(1, abs=0.6)
    assert found["truth"] is None
    assert read_camera(tmp_path / "he.json").fx == read_camera(photos / "camera.json").fx
    assert "Where to drive next" in (tmp_path / "page.html").read_text()


def test_an_arm_that_drives_by_itself_stops_at_the_wanted_sigma(capsys):
    found = run_json(capsys, "--synthetic", "--auto", "--until", "0.5mm", "--seed", "1")
    assert found["sigma"]["position_mm"] <= 0.5
    assert 4 <= found["views_used"] < 15
    assert len(found["driven"]) >= 1
    assert found["truth"]["position_error_mm"] < 2.0
    assert found["truth"]["wrist_from_cam"]["translation_m"] == pytest.approx([0.055, 0.012, 0.035])


def test_corner_files_a_limit_and_text(capsys, corner_set):
    found = run_json(capsys, *corner_set)
    assert found["views_used"] == 10
    assert run([*COMMAND, *corner_set, "--max-sigma", "0.0001"]) == 3
    captured = capsys.readouterr()
    assert "wrist_from_cam" in captured.out
    assert "the arm" in captured.out
    assert "limit missed" in captured.err


def test_joint_values_and_the_arms_model(capsys, corner_set):
    found = run_json(capsys, *corner_set, "--arm", "column", "--geometry")
    assert found["arm"]["joint_names"] == ["d1", "theta2", "theta3", "theta4", "theta5"]
    assert found["next_poses"]["poses"][0]["joints"] is not None


def test_a_camera_freed(capsys, corner_set):
    fixed = run_json(capsys, *corner_set, "--intrinsics", "fixed")
    free = run_json(capsys, *corner_set, "--intrinsics", "free")
    assert free["camera"]["fx"] != fixed["camera"]["fx"]
    assert free["camera"]["fx"] == pytest.approx(fixed["camera"]["fx"], rel=0.01)


def test_touches_give_the_tool_centre(capsys, corner_set, tmp_path):
    made = hand_eye_set(views=10, seed=2)
    rng = np.random.default_rng(0)
    tip, points = np.array([0.0, 0.0, 0.15]), rng.choice(54, 5, replace=False)
    turns = made.said.rotation[:5]
    at = made.cell.far_from_board.apply(made.board.points[points]) - turns @ tip
    rows = zip(at, quaternions(turns), points, strict=True)
    lines = [",".join(map(repr, [*map(float, place), *map(float, q), int(k)])) for place, q, k in rows]
    path = tmp_path / "touches.csv"
    path.write_text("\n".join(["x_m,y_m,z_m,qw,qx,qy,qz,point", *lines]))
    found = run_json(capsys, *corner_set, "--touches", path)
    off = np.array(found["tool"]["wrist_from_tool_m"]) - tip
    assert (np.abs(off) < 4e-3 * np.array(found["tool"]["sigma_mm"])).all()
    assert run([*COMMAND, *corner_set, "--touches", str(path)]) == 0
    assert "tool centre in the wrist" in capsys.readouterr().out
    path.write_text("\n".join(["x_m,y_m,z_m,qw,qx,qy,qz,point", "0,0,0,1,0,0,0,99"]))
    assert "0 to 53" in refused(capsys, *corner_set, "--touches", path)


def columns(header: str, rows: list[str], keep) -> list[str]:
    names = header.split(",")
    index = [i for i, name in enumerate(names) if keep(name)]
    return [",".join(line.split(",")[i] for i in index) for line in (header, *rows)]


def test_bad_poses_are_named(capsys, corner_set, tmp_path):
    path = tmp_path / "poses.csv"
    header, *rows = path.read_text().splitlines()
    bare = columns(header, rows, lambda name: name != "image")

    def said(lines: list[str]) -> str:
        path.write_text("\n".join(lines))
        return refused(capsys, *corner_set)

    assert "8 poses and there are 10 pictures" in said(bare[:-2])
    assert "shuffled" in said([bare[0], *(bare[1 + i] for i in (3, 6, 1, 7, 0, 9, 5, 2, 8, 4))])
    assert "out of step by 1 step" in said([bare[0], *bare[2:], bare[1]])
    assert "give --pose-unit mm" in said(scaled(header, rows, 1000))
    assert "give --rotation xyzw" in said([header, *map(rolled, rows)])
    assert "no pose" in said([header])
    assert "not of length one" in said(scaled(header, rows, 1000, names="q"))
    assert "none is given" in said([header, *(f"other{row}" for row in rows)])


def scaled(header: str, rows: list[str], factor: float, names: str = "xyz") -> list[str]:
    found = [name[0] in names and not name.startswith("theta") for name in header.split(",")]
    lines = []
    for row in rows:
        pairs = zip(row.split(","), found, strict=True)
        lines.append(",".join(str(float(cell) * factor) if ours else cell for cell, ours in pairs))
    return [header, *lines]


def rolled(row: str) -> str:
    """The quaternion written x, y, z, w under a header that says w, x, y, z."""
    cells = row.split(",")
    return ",".join([*cells[:4], *cells[5:8], cells[4], *cells[8:]])


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ((), "--synthetic"),
        (("--setup", "eye-on-foot", "--synthetic"), "eye-in-hand or eye-to-hand"),
        (("--auto",), "--synthetic"),
        (("photo.png", "--synthetic"), "given alone"),
        (("photo.png",), "--poses"),
        (("photo.png", "--rotation", "upside"), "--rotation"),
        (("photo.png", "--pose-unit", "yard"), "--pose-unit"),
        (("photo.png", "--angle-unit", "grad"), "--angle-unit"),
        (("photo.png", "--intrinsics", "vague"), "known or fixed or free"),
        (("photo.png", "--geometry"), "--arm"),
        (("--synthetic", "--arm", "snake"), "column, eye-in-hand"),
        (("--synthetic", "--link-error", "1"), "--link-error"),
        (("--corners", "/nowhere"), "--model-points"),
    ],
)
def test_options_that_make_no_sense_are_refused_before_any_work(capsys, options, says):
    assert says in refused(capsys, *options)
