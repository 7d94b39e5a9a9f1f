"""The commands that take long, each with small material of its own, and what their outputs are."""

import hashlib
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

__all__ = ["COMMANDS", "Ended", "LongCommand", "contents", "material", "run", "start", "whole"]

ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class LongCommand:
    """Words after `vr`; {in} and {out} stand for folders, and all outputs go to {out}."""

    name: str
    words: tuple[str, ...]
    unlike: tuple[str, ...] = ()
    """Files that differ from run to run, such as pages that tell how long it took."""
    set: Mapping[str, str] = field(default_factory=dict)

    def command(self, given: Path, out: Path) -> list[str]:
        """The whole command line."""
        words = [word.replace("{in}", str(given)).replace("{out}", str(out)) for word in self.words]
        return [sys.executable, "-m", "vision_robot_cli", *words]


CALIBRATE = ("calibrate", "{in}/boards", "--size", "9x6", "--square", "25mm", "--json")
COMMANDS = {
    command.name: command
    for command in (
        LongCommand("synth", ("synth", "single-rod", "--frames", "6", "--size", "96x72", "-o", "{out}/rod")),
        LongCommand(
            "synth, two workers",
            ("synth", "crowd", "--frames", "12", "--size", "96x72", "--workers", "2", "-o", "{out}/set"),
        ),
        LongCommand(
            "benchmark",
            (
                "benchmark",
                "calibration",
                "--scene",
                "views=4",
                "--method",
                "cv2",
                "--method",
                "cv2-sb",
                "--seeds",
                "2",
                "-o",
                "{out}/results",
                "--report",
                "{out}/page.html",
                "--json",
            ),
            unlike=("page.html", "results/"),
        ),
        LongCommand(
            "calibrate",
            (*CALIBRATE, "-o", "{out}/camera.yaml", "--report", "{out}/page.html"),
            unlike=("page.html",),
        ),
        LongCommand(
            "track video",
            (
                "track",
                "video",
                "{in}/clip.mkv",
                "--tracker",
                "rgb",
                "--color",
                "red",
                "-o",
                "{out}/tracks.csv",
                "--overlay",
                "{out}/seen.avi",
                "--report",
                "{out}/page.html",
                "--json",
            ),
            unlike=("page.html",),
        ),
        LongCommand(
            "pick", ("pick", "--episodes", "2", "--report", "{out}/page.html", "--json"), ("page.html",)
        ),
        LongCommand("ik export", ("ik", "export", "column", "-o", "{out}/firmware", "--json")),
        LongCommand(
            "extrinsics plane",
            (
                "extrinsics",
                "plane",
                "{in}/boards/0.png",
                "--camera",
                "{in}/camera.json",
                "--size",
                "9x6",
                "--square",
                "25mm",
                "-o",
                "{out}/plane.json",
                "--report",
                "{out}/page.html",
                "--json",
            ),
            unlike=("page.html",),
        ),
        LongCommand(
            "extrinsics hand-eye",
            (
                "extrinsics",
                "hand-eye",
                "--synthetic",
                "--views",
                "6",
                "-o",
                "{out}/hand_eye.json",
                "--report",
                "{out}/page.html",
                "--json",
            ),
            unlike=("page.html",),
        ),
        LongCommand(
            "undistort", ("undistort", "{in}/boards", "--camera", "{in}/camera.json", "-o", "{out}/straight")
        ),
        LongCommand("demo", ("demo", "-o", "{out}/demo", "--views", "6"), unlike=("demo/report.html",)),
    )
}
"""Name -> command."""


def material(folder: Path) -> None:
    """Photos of a board, their camera, and a film of a red disc."""
    sys.path.insert(0, str(ROOT))
    from tests.track.scenes import SIZE, moving, rendered
    from vision_robot.formats import write_camera
    from vision_robot.video import VideoWriter
    from vision_robot_synth.calibration import calibration_set

    made = calibration_set(views=6, seed=1)
    (folder / "boards").mkdir(parents=True)
    for i, image in enumerate(made.images()):
        cv2.imwrite(str(folder / "boards" / f"{i}.png"), image)
    write_camera(made.camera, folder / "camera.json")
    with VideoWriter(folder / "clip.mkv", SIZE, 25) as writer:
        for frame in rendered(moving, 60):
            writer.write(np.ascontiguousarray(frame))


@dataclass(frozen=True)
class Ended:
    """How a process ended."""

    code: int
    out: str
    err: str
    seconds: float

    @property
    def is_clean(self) -> bool:
        """No traceback, and when it failed one line that says so, the last of stderr."""
        lines = self.err.strip().splitlines()
        told = self.code == 0 or (bool(lines) and lines[-1].startswith("vr: "))
        return told and "Traceback" not in self.err + self.out and "Exception ignored" not in self.err


def _hears_interrupts() -> None:
    """Shells start what runs in their background deaf to Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def start(command: Sequence[str], **options: object) -> "subprocess.Popen[str]":
    """The process, at the head of a session of its own."""
    usual: dict[str, object] = {
        "stdin": subprocess.DEVNULL,
        "stdout": subprocess.PIPE,
        "stderr": subprocess.PIPE,
        "text": True,
        "errors": "backslashreplace",
        "start_new_session": True,
        "preexec_fn": _hears_interrupts,
        "cwd": ROOT,
    }
    return subprocess.Popen(command, **{**usual, **options})  # type: ignore[call-overload]


def run(command: Sequence[str], *, timeout: float = 300, **options: object) -> Ended:
    """From its start to its end."""
    begin = time.monotonic()
    process = start(command, **options)
    try:
        out, err = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        out, err = process.communicate()
        err += "\nhang"
    return Ended(process.returncode, out or "", err or "", time.monotonic() - begin)


def contents(folder: Path) -> dict[str, str]:
    """Hash of each file by its name, those whose names begin with a dot as well."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def whole(command: LongCommand, folder: Path, right: Mapping[str, str]) -> list[str]:
    """What is wrong with the outputs of a finished run, given those of an undisturbed one."""
    found = contents(folder)
    wrong = [f"{name} is missing" for name in right if name not in found]
    wrong += [f"{name} is too many" for name in found if name not in right]
    for name, hashed in found.items():
        if name in right and not name.startswith(command.unlike or ("\0",)):
            wrong += [f"{name} differs"] if hashed != right[name] else []
        elif name in right:
            wrong += _half_written(folder / name)
    return wrong


def _half_written(path: Path) -> list[str]:
    """For files that differ from run to run: their ends."""
    text = path.read_text(encoding="utf-8", errors="replace").rstrip()
    ends = {".html": "</html>", ".json": "}"}.get(path.suffix, "")
    return (
        [] if text and text.endswith(ends) and not re.search("\0", text) else [f"{path.name} is half-written"]
    )
