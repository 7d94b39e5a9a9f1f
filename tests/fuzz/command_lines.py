"""Whole commands, run in this process: on spoiled files, and with spoiled words."""

import io
import json
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import numpy as np

from tests.fuzz.readers import GOALS_CSV, POSE, POSES_CSV, SMALL, picture
from tests.fuzz.subject import Subject
from tests.views import CAMERAS, make_views
from vision_robot.errors import BadInput
from vision_robot.formats import write_camera
from vision_robot.formats.work_plane import write_work_plane
from vision_robot.geometry import WorkPlane

__all__ = ["COMMAND_LINES"]


class Refused(BadInput):
    """The command said in one line that it cannot do that."""


class Unforeseen(Exception):
    """It ended in another way."""


def spoken(words: Sequence[str]) -> None:
    """Run `vr` with these words. Raises Refused and Unforeseen."""
    from vision_robot_cli.main import run

    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        code = run([*words, "--json"])
    said, told = out.getvalue(), err.getvalue()
    if code == 0:
        if not isinstance(json.loads(said), dict):
            raise Unforeseen(f"no object of JSON: {said[:100]}")
        return
    lines = told.strip().splitlines()
    if (
        code not in (1, 2)
        or not lines
        or "--debug for the traceback" in told
        or not lines[-1].startswith("vr: error")
    ):
        raise Unforeseen(f"code {code}: {told[-300:]}")
    if said:
        raise Unforeseen(f"code {code}, and on stdout {said[:100]}")
    raise Refused(lines[-1])


def _command(name: str, make: Callable[[Path], object], *words: str, kept: tuple[str, ...] = ()) -> Subject:
    """A command whose words name files of the folder as {in}/..."""

    def make_one(folder: Path) -> Sequence[Path]:
        (folder / "0").mkdir()
        make(folder / "0")
        return [folder / "0"]

    def read(folder: Path) -> None:
        spoken([word.replace("{in}", str(folder)) for word in words])

    return Subject(f"vr {name}", make_one, read, kept)


def _views(folder: Path) -> None:
    views = make_views(CAMERAS["pinhole"], 5)
    (folder / "corners").mkdir()
    np.savetxt(folder / "model.txt", views.board[:, :2], fmt="%.6g")
    for i, view in enumerate(views.corners):
        np.savetxt(folder / "corners" / f"{i}.txt", view.pixels, fmt="%.4f")


def _posed(folder: Path) -> None:
    from tests.hand_eye_sets import posed
    from vision_robot_synth.quaternions import quaternions

    made = posed(count=6)
    (folder / "corners").mkdir()
    np.savetxt(folder / "model.txt", made.board[:, :2], fmt="%.6g")
    rows = ["x_m,y_m,z_m,qw,qx,qy,qz"]
    for i, view in enumerate(made.corners):
        np.savetxt(folder / "corners" / f"{i}.txt", view.pixels, fmt="%.4f")
    for shift, q in zip(made.said.translation, quaternions(made.said.rotation), strict=True):
        rows.append(",".join(f"{value:.9g}" for value in (*shift, *q)))
    (folder / "poses.csv").write_text("\n".join(rows) + "\n")
    write_camera(made.camera, folder / "camera.json")


def _plane_and_points(folder: Path) -> None:
    write_work_plane(WorkPlane.exact(SMALL, POSE), folder / "plane.json")
    (folder / "points.csv").write_text("u_px,v_px,sigma_px\n30,20,0.5\n31.5,24,0.5\n")


def _marked_plane(folder: Path) -> None:
    write_camera(SMALL, folder / "camera.json")
    xy = np.array([[0, 0], [0.1, 0], [0.1, 0.08], [0, 0.08], [0.05, 0.03]])
    pixels = WorkPlane.exact(SMALL, POSE).pixels(xy)
    rows = [f"{u:.4f},{v:.4f},{1e3 * x:g},{1e3 * y:g}" for (u, v), (x, y) in zip(pixels, xy, strict=True)]
    (folder / "points.csv").write_text("\n".join(["u_px,v_px,x_mm,y_mm", *rows]) + "\n")


def _pivots(folder: Path) -> None:
    from vision_robot.geometry import SE3
    from vision_robot_synth.quaternions import quaternions

    rng = np.random.default_rng(0)
    turns = SE3.from_rotvec(rng.normal(size=(6, 3)), np.zeros((6, 3))).rotation
    shifts = np.array([0.3, 0, 0.1]) - turns @ np.array([0.0, 0, 0.2])
    rows = [",".join(f"{v:.9g}" for v in (*t, *q)) for t, q in zip(shifts, quaternions(turns), strict=True)]
    (folder / "poses.csv").write_text("\n".join(["x_m,y_m,z_m,qw,qx,qy,qz", *rows]) + "\n")


def _clip(folder: Path) -> None:
    from tests.track.scenes import SIZE, moving, rendered
    from vision_robot.video import VideoWriter

    with VideoWriter(folder / "v.avi", SIZE, 25) as writer:
        for frame in rendered(moving, 12):
            writer.write(np.ascontiguousarray(frame))
    (folder / "options.toml").write_text('[rgb]\ncolor = "red"\n')


def _photo(folder: Path) -> None:
    import cv2

    write_camera(SMALL, folder / "camera.yaml")
    cv2.imwrite(str(folder / "a.png"), picture())


LINES: dict[str, list[str]] = {
    "calibrate": [
        "calibrate",
        "--corners",
        "{in}/corners",
        "--model-points",
        "{in}/model.txt",
        "--image-size",
        "1280x960",
        "--model",
        "pinhole",
        "--fix",
        "skew=0",
        "--prior",
        "cx=640+-5",
        "--warp",
        "0",
        "--seed",
        "0",
    ],
    "measure": [
        "measure",
        "30,20",
        "31.5,24",
        "--plane",
        "{in}/plane.json",
        "--sigma-px",
        "0.5",
        "--height",
        "6mm",
        "--height-sigma",
        "0.5mm",
    ],
    "ik solve": [
        "ik",
        "solve",
        "--position",
        "350,100,150mm",
        "--yaw",
        "30deg",
        "--limit",
        "d1=0..0.4m",
        "--near",
        "d1=100mm,theta2=30deg",
        "--method",
        "auto",
        "--task",
        "pose",
    ],
    "track": [
        "track",
        "video",
        "{in}/v.avi",
        "--tracker",
        "rgb",
        "--color",
        "red",
        "--set",
        "rgb.color=red",
        "--max-gap",
        "1.0",
        "--confirm",
        "3",
        "--max-objects",
        "5",
        "--height",
        "0mm",
    ],
    "plane": [
        "extrinsics",
        "plane",
        "--points",
        "{in}/points.csv",
        "--camera",
        "{in}/camera.json",
        "--sigma-px",
        "0.5",
        "--max-rms",
        "5",
    ],
}


def _words() -> Subject:
    makers = {
        "calibrate": _views,
        "measure": _plane_and_points,
        "ik solve": lambda _: None,
        "track": _clip,
        "plane": _marked_plane,
    }

    def make(folder: Path) -> Sequence[Path]:
        made = []
        for name, line in LINES.items():
            place = folder / name
            place.mkdir()
            makers[name](place)
            (place / "words.json").write_text(json.dumps(line))
            made.append(place)
        return made

    def read(folder: Path) -> None:
        try:
            line = json.loads((folder / "words.json").read_text(encoding="utf-8"))
        except (ValueError, RecursionError) as error:
            raise Refused("no words") from error
        words = [word if isinstance(word, str) else json.dumps(word) for word in line or []]
        if any(word.startswith(("-o", "--out", "--rep", "--ov")) or "\0" in word for word in words):
            raise Refused("it would write where it is told")
        spoken([word.replace("{in}", str(folder)) for word in words])

    every = {f"{kind}/{i}.txt" for kind in ("corners",) for i in range(5)}
    kept = ("model.txt", "plane.json", "points.csv", "v.avi", "options.toml", "camera.json", *sorted(every))
    return Subject("vr with spoiled words", make, read, kept)


COMMAND_LINES = {
    subject.name: subject
    for subject in (
        _command(
            "convert",
            lambda f: write_camera(CAMERAS["brown5"], f / "camera.yaml"),
            "convert",
            "{in}/camera.yaml",
            "-o",
            "{in}/out.json",
        ),
        _command(
            "calibrate", _views, "calibrate", "--corners", "{in}/corners", "--model-points", "{in}/model.txt"
        ),
        _command(
            "extrinsics hand-eye",
            _posed,
            "extrinsics",
            "hand-eye",
            "--corners",
            "{in}/corners",
            "--model-points",
            "{in}/model.txt",
            "--poses",
            "{in}/poses.csv",
            "--camera",
            "{in}/camera.json",
        ),
        _command(
            "extrinsics plane",
            _marked_plane,
            "extrinsics",
            "plane",
            "--points",
            "{in}/points.csv",
            "--camera",
            "{in}/camera.json",
        ),
        _command("extrinsics tool", _pivots, "extrinsics", "tool", "--pivot", "--poses", "{in}/poses.csv"),
        _command(
            "measure", _plane_and_points, "measure", "--plane", "{in}/plane.json", "--csv", "{in}/points.csv"
        ),
        _command(
            "ik solve", lambda f: (f / "goals.csv").write_text(GOALS_CSV), "ik", "solve", "{in}/goals.csv"
        ),
        _command(
            "ik solve, poses",
            lambda f: (f / "goals.csv").write_text(POSES_CSV),
            "ik",
            "solve",
            "{in}/goals.csv",
        ),
        _command(
            "track video",
            _clip,
            "track",
            "video",
            "{in}/v.avi",
            "--tracker",
            "rgb",
            "--config",
            "{in}/options.toml",
        ),
        _command(
            "undistort", _photo, "undistort", "{in}/a.png", "--camera", "{in}/camera.yaml", "-o", "{in}/out"
        ),
        _words(),
    )
}
"""Name -> what is fuzzed."""
