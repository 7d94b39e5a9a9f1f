"""Which video codecs write a film here that can be read back."""

import tempfile
from pathlib import Path

from vision_robot.machine.apart import Crashed, apart
from vision_robot.machine.check import Check, Status
from vision_robot.machine.packages import install_command

__all__ = ["CODECS", "checks"]

# Code and container. The first two are what the library itself writes; the others are welcome.
CODECS = (("MJPG", "avi"), ("FFV1", "mkv"), ("mp4v", "mp4"), ("VP90", "webm"), ("avc1", "mp4"))
NEEDED = ("MJPG", "FFV1")
FRAMES = 4


def checks() -> list[Check]:
    """One finding for each codec."""
    try:
        worked = apart(trial_films)
    except Crashed:
        worked = {}
    found = []
    for code, container in CODECS:
        name = f"{code} in .{container}"
        if worked.get(code):
            found.append(Check("video", name, Status.OK, "writes and reads"))
        else:
            status = Status.BROKEN if code in NEEDED else Status.ABSENT
            mend = install_command("--reinstall", "opencv-contrib-python-headless") if code in NEEDED else ""
            found.append(Check("video", name, status, "cannot be written here", mend))
    return found


def trial_films() -> dict[str, bool]:
    """For each code: do as many frames come back as were written?"""
    with tempfile.TemporaryDirectory() as folder:
        return {code: _film(Path(folder) / f"{code}.{container}", code) for code, container in CODECS}


def _film(path: Path, code: str) -> bool:
    import cv2
    import numpy as np

    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*code), 25.0, (64, 48))
    if not writer.isOpened():
        return False
    for k in range(FRAMES):
        writer.write(np.full((48, 64, 3), 60 * k, np.uint8))
    writer.release()
    reader = cv2.VideoCapture(str(path))
    count = 0
    while reader.read()[0]:
        count += 1
    reader.release()
    return count == FRAMES
