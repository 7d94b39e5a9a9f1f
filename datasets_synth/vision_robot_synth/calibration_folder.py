"""A calibration set as a dataset on disk: dataset.json, frames/*.png, corners.csv."""

import hashlib
import json
import os
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path

import cv2
import numpy as np

import vision_robot
from vision_robot.errors import UnwritableOutput
from vision_robot.files import write_bytes, write_text
from vision_robot.sim.gl import choose_back_end
from vision_robot_synth.calibration import CalibrationSet

__all__ = ["SCHEMA", "write_calibration_set"]

SCHEMA = "vr.dataset/1"
RECIPE = "calibration"
FRAME = "frames/{:04d}.png"


def write_calibration_set(views: CalibrationSet, folder: Path | str) -> Path:
    """Write the set to `folder` and return the path of its dataset.json.

    The folder appears complete or not at all: frames gather in a hidden folder beside it,
    named after the content to come, where a killed run goes on; the same set on the same
    machine gives the same bytes. A folder that already holds this set is left as it is.
    Raises UnwritableOutput where anything else is in the way, and MissingOpenGL.
    """
    folder = Path(folder)
    described = _described(views)
    text = json.dumps(described, indent=1, allow_nan=False) + "\n"
    done = folder / "dataset.json"
    if done.is_file() and done.read_text() == text:
        return done
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise UnwritableOutput(folder, "it exists and holds something else")
    key = hashlib.sha256(text.encode()).hexdigest()[:16]
    partial = folder.absolute().parent / f".{folder.name}.{key}.partial"
    try:
        partial.mkdir(parents=True, exist_ok=True)
        _write_frames(views, partial)
        write_text(partial / "corners.csv", _corner_table(views))
        write_text(partial / "dataset.json", text)
        # Renaming onto an empty folder is allowed, onto a full one it fails.
        os.replace(partial, folder)  # noqa: PTH105
    except OSError as error:
        raise UnwritableOutput(folder, error.strerror or str(error)) from error
    return done


def _described(views: CalibrationSet) -> dict:
    """Everything that determines the bytes of the dataset, and the truth."""
    poses = views.cam_from_board
    rotvecs, translations = poses.rotvec().tolist(), poses.translation.tolist()
    board = {"name": views.board.name, "description": views.board.description, **asdict(views.board)}
    return {
        "schema": SCHEMA,
        "recipe": RECIPE,
        "seed": views.seed,
        "versions": {
            "vision_robot": vision_robot.__version__,
            **{name: version(name) for name in ("mujoco", "numpy")},
            "opencv": cv2.__version__,
        },
        "renderer": choose_back_end().renderer,
        "sensor": asdict(views.sensor),
        "board": board,
        "camera": asdict(views.camera),
        "corners": "corners.csv",
        "views": [
            {
                "image": FRAME.format(i),
                "cam_from_board": {"rotvec_rad": rotvecs[i], "translation_m": translations[i]},
            }
            for i in range(len(views))
        ],
    }


def _write_frames(views: CalibrationSet, partial: Path) -> None:
    # Frames are written whole and in order: the first that is missing is where to go on.
    first = next((i for i in range(len(views)) if not (partial / FRAME.format(i)).is_file()), len(views))
    for i, image in enumerate(views.images(slice(first, None)), start=first):
        # Noise does not compress: the fastest level costs 2 % more bytes than the slowest.
        _, png = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 1])
        write_bytes(partial / FRAME.format(i), png.tobytes())


def _corner_table(views: CalibrationSet) -> str:
    lines = ["image,id,u_px,v_px"]
    for i, pixels in enumerate(views.corners):
        seen = np.flatnonzero(np.isfinite(pixels[:, 0]))
        lines += [f"{FRAME.format(i)},{j},{pixels[j, 0]:.9f},{pixels[j, 1]:.9f}" for j in seen.tolist()]
    return "\n".join(lines) + "\n"
