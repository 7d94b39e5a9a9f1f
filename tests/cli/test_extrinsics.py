"""`vr extrinsics plane`, `rig` and `tool` as a person runs them; then `vr measure` and `vr undistort`."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from vision_robot.formats import read_camera, write_known_camera
from vision_robot.formats.rig import read_rig
from vision_robot.formats.work_plane import read_work_plane, write_work_plane
from vision_robot.geometry import SE3, Camera, KnownCamera, WorkPlane
from vision_robot_cli.main import run
from vision_robot_synth.rig import rig_set
from vision_robot_synth.table import table_set


def answered(capsys, *words) -> dict:
    assert run([*map(str, words), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def refused(capsys, *words) -> str:
    assert run(list(map(str, words))) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    return captured.err.strip().splitlines()[-1]


@pytest.fixture(scope="module")
def table(tmp_path_factory) -> Path:
    """Photos of a board on a table, the camera with a covariance, and the truth."""
    folder = tmp_path_factory.mktemp("table")
    made = table_set(seed=3, places=2)
    (folder / "photos").mkdir()
    for i, image in enumerate(made.images()):
        cv2.imwrite(str(folder / "photos" / f"{i}.png"), image)
    sigma = np.array([0.3, 0.3, 0.4, 0.4, 0, 1e-3, 2e-3, 5e-5, 5e-5, 1e-3])
    write_known_camera(KnownCamera(made.camera, np.diag(sigma**2)), folder / "camera.json")
    laid = made.station_from_board[0]
    offset = ",".join(f"{1000 * part:.6f}mm" for part in laid.translation[:2])
    truth = WorkPlane.exact(made.camera, made.cam_from_station)
    write_work_plane(truth, folder / "truth.json")
    given = [str(folder / "photos"), "--camera", str(folder / "camera.json"), "--offset", offset]
    written = ["--height", "3mm", "-o", str(folder / "plane.json"), "--report", str(folder / "plane.html")]
    done = run(["extrinsics", "plane", *given, *written])
    assert done == 0
    return folder


def test_plane_from_photos(table, capsys):
    found, truth = (read_work_plane(table / name) for name in ("plane.json", "truth.json"))
    off = found.cam_from_station.inverse().translation - truth.cam_from_station.inverse().translation
    assert np.abs(off).max() < 2e-4
    assert found.covariance[0, -1] != 0
    page = (table / "plane.html").read_text()
    assert "How well a point is measured" in page
    assert page.count("<svg") >= 5
    words = ["extrinsics", "plane", table / "photos", "--camera", table / "camera.json"]
    told = answered(capsys, *words)
    assert told["schema"] == "vr.plane/1"
    assert told["points"] == 108
    assert [one["image"] for one in told["elsewhere"]] == ["1.png"]
    assert told["truth"] is None
    assert run(list(map(str, [*words, "--max-rms", "0.0001"]))) == 3


def test_plane_from_marked_points(table, capsys, tmp_path):
    truth = read_work_plane(table / "truth.json")
    marks = np.array([[-0.05, -0.04], [0.06, -0.03], [0.05, 0.05], [-0.06, 0.04], [0.0, 0.01]])
    rows = [
        f"{u},{v},{1000 * x},{1000 * y}" for (u, v), (x, y) in zip(truth.pixels(marks), marks, strict=True)
    ]
    (tmp_path / "points.csv").write_text("u_px,v_px,x_mm,y_mm\n" + "\n".join(rows) + "\n")
    words = ["extrinsics", "plane", "--points", tmp_path / "points.csv", "--camera", table / "camera.json"]
    told = answered(capsys, *words, "--sigma-px", "0.5")
    centre = truth.cam_from_station.inverse().translation
    assert np.abs(np.array(told["camera_position_mm"]) - 1000 * centre).max() < 1e-4
    assert told["noise_px"] == pytest.approx(0.5)
    (tmp_path / "bad.csv").write_text("u,v,x,y\n1,2,3,4\n")
    assert "its first line lacks u_px" in refused(capsys, *words[:3], tmp_path / "bad.csv", *words[4:])
    (tmp_path / "bad.csv").write_text("u_px,v_px,x_mm,y_mm\n1,2,3,wide\n")
    assert "line 2: y_mm is 'wide'" in refused(capsys, *words[:3], tmp_path / "bad.csv", *words[4:])


def test_plane_refuses_in_words(table, capsys, tmp_path):
    photos, camera = table / "photos", table / "camera.json"
    assert "--camera is None" in refused(capsys, "extrinsics", "plane", photos)
    words = ["extrinsics", "plane", photos, "--camera", camera]
    assert "up or down" in refused(capsys, *words, "--z", "sideways")
    assert "a length with its unit" in refused(capsys, *words, "--height", "3")
    assert "no chessboard 7x5" in refused(capsys, *words, "--size", "7x5")
    write_known_camera(KnownCamera.exact(Camera(640, 480, 500, 500, 320, 240)), tmp_path / "small.json")
    wrong = ["extrinsics", "plane", photos, "--camera", tmp_path / "small.json"]
    assert "one resolution" in refused(capsys, *wrong)


def test_measure(table, capsys, tmp_path):
    plane, truth = table / "plane.json", read_work_plane(table / "truth.json")
    where = np.array([[0.03, -0.02], [-0.04, 0.05]])
    pixels = truth.pixels(where)
    words = [f"{u:.6f},{v:.6f}" for u, v in pixels]
    told = answered(capsys, "measure", *words, "--plane", plane, "--sigma-px", "0.1")
    assert told["schema"] == "vr.measure/1"
    for point, position in zip(told["points"], where, strict=True):
        assert [point["x_mm"], point["y_mm"]] == pytest.approx(1000 * position, abs=0.1)
        assert 0 < point["sigma_x_mm"] < 0.2
    length = told["lengths"][0]
    assert length["length_mm"] == pytest.approx(1000 * np.linalg.norm(where[1] - where[0]), abs=0.1)
    rows = "\n".join(f"{u},{v}" for u, v in pixels)
    (tmp_path / "p.csv").write_text(f"u_px,v_px\n{rows}\n")
    table_out = tmp_path / "out.csv"
    assert (
        run(["measure", "--csv", str(tmp_path / "p.csv"), "--plane", str(plane), "-o", str(table_out)]) == 0
    )
    assert table_out.read_text().startswith("u_px,v_px,x_mm,y_mm,sigma_x_mm,sigma_y_mm\n")
    capsys.readouterr()
    board = answered(
        capsys, "measure", "--image", table / "photos" / "1.png", "--plane", plane, "--height", "3mm"
    )
    assert board["board"]["rms_mm"] < 0.02
    assert abs(board["board"]["scale_error_percent"]) < 0.1
    assert run(["measure", words[0], "--plane", str(plane), "--max-sigma", "1e-6"]) == 3


def test_measure_refuses_what_sees_no_plane(table, capsys, tmp_path):
    plane = table / "plane.json"
    assert "outside the picture of 1280x960" in refused(capsys, "measure", "5000,3", "--plane", plane)
    level = SE3(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), np.array([0, 0.5, 0]))
    write_work_plane(WorkPlane.exact(Camera(640, 480, 500, 500, 320, 240), level), tmp_path / "level.json")
    said = refused(capsys, "measure", "300,400", "310,100", "--plane", tmp_path / "level.json")
    assert "point 2 at (310, 100) px sees no part of the plane (it lies above the horizon)" in said
    assert "two numbers u,v" in refused(capsys, "measure", "300;400", "--plane", plane)
    assert "none, or from several places" in refused(capsys, "measure", "--plane", plane)
    assert "vr extrinsics plane -o" in refused(capsys, "measure", "1,1", "--plane", table / "camera.json")


def test_the_worked_example_of_the_origin_measured_rightly(capsys, tmp_path):
    """MATLAB's export is converted, and pixel (320, 240) means what K [r1 r2 t] says, not the text."""
    transposed = np.array([[1064, 0, 0], [-0.8118, 1065.8, 0], [258.3899, 295.171, 1]])
    R = np.array([[0.9992, 0.0027, -0.0399], [-0.002, 0.9999, 0.0136], [0.0399, -0.0162, 0.9991]])
    t = np.array([-226.1425, -166.5716, 1240.0])
    rows = "; ".join(" ".join(map(str, row)) for row in transposed.tolist())
    (tmp_path / "k.m").write_text(f"IntrinsicMatrix = [{rows}];\nImageSize = [480 640];\n")
    assert run(["convert", str(tmp_path / "k.m"), "-o", str(tmp_path / "camera.json")]) == 0
    capsys.readouterr()
    camera = read_camera(tmp_path / "camera.json")
    assert camera.skew == -0.8118
    U, _, Vt = np.linalg.svd(R)
    write_work_plane(WorkPlane.exact(camera, SE3(U @ Vt, t / 1000)), tmp_path / "plane.json")
    told = answered(capsys, "measure", "319,239", "--plane", tmp_path / "plane.json")
    x, y, w = np.linalg.inv(transposed.T @ np.column_stack([(U @ Vt)[:, 0], (U @ Vt)[:, 1], t])) @ [
        320,
        240,
        1,
    ]
    point = told["points"][0]
    assert [point["x_mm"], point["y_mm"]] == pytest.approx([x / w, y / w], abs=1e-6)
    by_the_text = np.array([(320 + 2.4079) / 0.0106, (240 + 1.7735) / 0.0107])
    assert np.linalg.norm(by_the_text - [point["x_mm"], point["y_mm"]]) > 30_000


def test_undistort(table, capsys, tmp_path):
    out = tmp_path / "flat"
    words = ["undistort", table / "photos", "--camera", table / "camera.json", "-o", out]
    told = answered(capsys, *words, "--keep", "all")
    assert told["pictures"] == 2
    flat = read_camera(out / "camera.json")
    assert flat.model == "pinhole"
    truth = read_work_plane(table / "truth.json")
    write_work_plane(WorkPlane.exact(flat, truth.cam_from_station), tmp_path / "flat.json")
    # Corners found in the flat picture, measured by the flat camera, form the board again.
    words = ["measure", "--image", out / "0.png", "--plane", tmp_path / "flat.json", "--height", "3mm"]
    assert answered(capsys, *words)["board"]["rms_mm"] < 0.03
    video = cv2.VideoWriter(str(tmp_path / "v.avi"), cv2.VideoWriter.fourcc(*"MJPG"), 10, (1280, 960))
    for _ in range(3):
        video.write(np.full((960, 1280, 3), 90, np.uint8))
    video.release()
    made = answered(
        capsys,
        "undistort",
        tmp_path / "v.avi",
        "--camera",
        table / "camera.json",
        "-o",
        tmp_path / "flat.avi",
    )
    assert made["pictures"] == 3
    assert read_camera(made["camera_file"]).model == "pinhole"
    assert "valid" in refused(
        capsys, "undistort", table / "photos", "--camera", table / "camera.json", "--keep", "x"
    )


@pytest.fixture(scope="module")
def rig_folders(tmp_path_factory) -> list[Path]:
    """Pictures of three cameras, a folder each."""
    root = tmp_path_factory.mktemp("rig")
    made = rig_set(moments=6, seed=1)
    folders = []
    for i, name in enumerate(made.rig.names):
        folders.append(root / name)
        folders[-1].mkdir()
        for moment, image in made.images(i):
            cv2.imwrite(str(folders[-1] / f"{moment}.png"), image)
        write_known_camera(KnownCamera.exact(made.rig.cameras[i]), root / f"{name}.json")
    return folders


def test_rig_from_folders(rig_folders, capsys, tmp_path):
    cameras = [word for folder in rig_folders for word in ("--camera", folder.with_suffix(".json"))]
    report, out = tmp_path / "rig.html", tmp_path / "rig.json"
    told = answered(capsys, "extrinsics", "rig", *rig_folders, *cameras, "-o", out, "--report", report)
    assert told["schema"] == "vr.rig/1"
    truth = rig_set(moments=6, seed=1).rig
    found = read_rig([out])
    assert found.names == ("left", "right", "top")
    off = found.cam_from_rig.inverse().translation - truth.cam_from_rig.inverse().translation
    assert np.abs(off).max() < 5e-4
    assert "Triangulated points" in report.read_text()
    assert "two or more" in refused(capsys, "extrinsics", "rig", rig_folders[0])
    assert "all 3 folders" in refused(capsys, "extrinsics", "rig", *rig_folders, *cameras[:2])


def test_tool_from_poses_and_sightings(capsys, tmp_path):
    from tests.extrinsics.test_tool import CAMERA, PLACES, TIP, robot, seen, touching

    poses = robot(15)
    write_known_camera(KnownCamera.exact(CAMERA), tmp_path / "camera.json")
    turns = poses.rotvec()
    lines = [
        ",".join(f"{value:.12f}" for value in (*shift, *turn))
        for shift, turn in zip(poses.translation, turns, strict=True)
    ]
    (tmp_path / "poses.csv").write_text("x,y,z,rx,ry,rz\n" + "\n".join(lines) + "\n")
    pixels = seen(poses, PLACES[0], noise_px=0.05)
    rows = [f"{i + 1},{u:.6f},{v:.6f}" for i, (u, v) in enumerate(pixels)]
    (tmp_path / "tips.csv").write_text("pose,u_px,v_px\n" + "\n".join(rows) + "\n")
    words = ["extrinsics", "tool", "--poses", tmp_path / "poses.csv", "--camera", tmp_path / "camera.json"]
    report, out = tmp_path / "tool.html", tmp_path / "tool.json"
    told = answered(capsys, *words, "--tips", tmp_path / "tips.csv", "-o", out, "--report", report)
    assert told["schema"] == "vr.tool/1"
    off = np.array(told["tip_mm"]) - 1000 * TIP
    assert (np.abs(off) < 4 * np.array(told["sigma_mm"])).all()
    assert json.loads(out.read_text())["tip_mm"] == told["tip_mm"]
    assert "In space" in report.read_text()
    (tmp_path / "tips.csv").write_text("pose,u_px,v_px\n1,2,3\n99,2,3\n")
    assert "from 1 to 15" in refused(capsys, *words, "--tips", tmp_path / "tips.csv")
    assert "none, or from both" in refused(capsys, *words)
    touches = touching(12, noise_m=1e-4)
    lines = [
        ",".join(f"{value:.12f}" for value in (*shift, *turn))
        for shift, turn in zip(touches.translation, touches.rotvec(), strict=True)
    ]
    (tmp_path / "touch.csv").write_text("x,y,z,rx,ry,rz\n" + "\n".join(lines) + "\n")
    pivot = answered(
        capsys,
        "extrinsics",
        "tool",
        "--poses",
        tmp_path / "touch.csv",
        "--pivot",
        "--report",
        tmp_path / "p.html",
    )
    assert np.array(pivot["tip_mm"]) == pytest.approx(1000 * TIP, abs=0.5)


def test_a_tip_rendered_on_the_arm_is_found_to_a_tenth_of_a_millimetre(capsys):
    told = answered(capsys, "extrinsics", "tool", "--synthetic", "--views", "12")
    assert told["truth"]["distance_mm"] <= 0.12
    assert told["rejected"] == []
