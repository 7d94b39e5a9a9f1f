"""OpenCV 4's calibrateHandEye and calibrateRobotWorldHandEye on the same poses; OpenCV 5's Python lacks them.

Runs in an interpreter of its own, since two OpenCV wheels in one environment overwrite each other: as a
script it reads poses from one file of arrays and writes what it found to another.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HAND_EYE = ("TSAI", "PARK", "HORAUD", "ANDREFF", "DANIILIDIS")
WORLD = ("SHAH", "LI")


def run_opencv4(python: str, far_from_mount: np.ndarray, cam_from_board: np.ndarray) -> dict[str, np.ndarray]:
    """mount_from_cam (trials, 4, 4) by method, from (trials, views, 4, 4) each."""
    with tempfile.TemporaryDirectory() as folder:
        given, found = Path(folder) / "given.npz", Path(folder) / "found.npz"
        np.savez(given, far_from_mount=far_from_mount, cam_from_board=cam_from_board)
        subprocess.run([python, __file__, str(given), str(found)], check=True)
        with np.load(found) as arrays:
            return {name: arrays[name] for name in arrays.files}


def main(given: str, found: str) -> None:
    """The part that runs beside OpenCV 4."""
    import cv2  # pyright: ignore[reportMissingImports]

    arrays = np.load(given)
    answers: dict[str, list[np.ndarray]] = {}
    for A, B in zip(arrays["far_from_mount"], arrays["cam_from_board"], strict=True):
        for name in HAND_EYE:
            method = getattr(cv2, f"CALIB_HAND_EYE_{name}")
            R, t = cv2.calibrateHandEye(  # pyright: ignore
                list(A[:, :3, :3]), list(A[:, :3, 3]), list(B[:, :3, :3]), list(B[:, :3, 3]), method=method
            )
            answers.setdefault(f"OpenCV 4 {name.title()}", []).append(_pose(R, t))
        back = np.linalg.inv(A)
        for name in WORLD:
            method = getattr(cv2, f"CALIB_ROBOT_WORLD_HAND_EYE_{name}")
            _, _, R, t = cv2.calibrateRobotWorldHandEye(  # pyright: ignore
                list(B[:, :3, :3]),
                list(B[:, :3, 3]),
                list(back[:, :3, :3]),
                list(back[:, :3, 3]),
                method=method,
            )
            answers.setdefault(f"OpenCV 4 {name.title()}", []).append(np.linalg.inv(_pose(R, t)))
    np.savez(found, **{name: np.array(poses) for name, poses in answers.items()})  # pyright: ignore


def _pose(R: np.ndarray, t: np.ndarray) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = R, np.ravel(t)
    return pose


if __name__ == "__main__":
    main(*sys.argv[1:])
