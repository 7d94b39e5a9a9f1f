"""Vision Robot: from camera to grasp, with numbers for how good every step is."""

import importlib
import os
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vision_robot.arm import read_arm as read_arm
    from vision_robot.arm.ik import InverseKinematics as InverseKinematics
    from vision_robot.calibrate import CalibrationResult as CalibrationResult
    from vision_robot.calibrate import Corners as Corners
    from vision_robot.calibrate import Settings as Settings
    from vision_robot.calibrate.boards import board_named as board_named
    from vision_robot.calibrate.detect import detect_boards as detect_boards
    from vision_robot.calibrate.judgement import judge as judge
    from vision_robot.dataset import open_dataset as open_dataset
    from vision_robot.extrinsics.plane import fit_plane as fit_plane
    from vision_robot.formats import read_camera as read_camera
    from vision_robot.formats import write_camera as write_camera
    from vision_robot.geometry import SE3 as SE3
    from vision_robot.geometry import Camera as Camera
    from vision_robot.geometry import WorkPlane as WorkPlane
    from vision_robot.images import open_images as open_images
    from vision_robot.track import tracker_named as tracker_named
    from vision_robot.tracks import Tracks as Tracks
    from vision_robot.video import Video as Video

__version__ = "0.1.0"

MOST_PIXELS = 250_000_000
"""Of a picture or a frame; a few bytes can claim thousands of millions."""

# OpenCV asks for this once, while it is loaded, and whatever loads it here comes later.
os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", str(MOST_PIXELS))

# The public face: each name is imported when it is first used, so that `import vision_robot` costs nothing.
PUBLIC = {
    "SE3": "vision_robot.geometry",
    "CalibrationResult": "vision_robot.calibrate",
    "Camera": "vision_robot.geometry",
    "Corners": "vision_robot.calibrate",
    "InverseKinematics": "vision_robot.arm.ik",
    "Settings": "vision_robot.calibrate",
    "Tracks": "vision_robot.tracks",
    "Video": "vision_robot.video",
    "WorkPlane": "vision_robot.geometry",
    "board_named": "vision_robot.calibrate.boards",
    "detect_boards": "vision_robot.calibrate.detect",
    "fit_plane": "vision_robot.extrinsics.plane",
    "judge": "vision_robot.calibrate.judgement",
    "open_dataset": "vision_robot.dataset",
    "open_images": "vision_robot.images",
    "read_arm": "vision_robot.arm",
    "read_camera": "vision_robot.formats",
    "tracker_named": "vision_robot.track",
    "write_camera": "vision_robot.formats",
}

__all__ = [
    "SE3",
    "CalibrationResult",
    "Camera",
    "Corners",
    "InverseKinematics",
    "Settings",
    "Tracks",
    "Video",
    "WorkPlane",
    "board_named",
    "detect_boards",
    "fit_plane",
    "judge",
    "open_dataset",
    "open_images",
    "read_arm",
    "read_camera",
    "tracker_named",
    "write_camera",
]


def __getattr__(name: str) -> Any:
    if name not in PUBLIC:
        raise AttributeError(f"module 'vision_robot' has no attribute {name!r}; it has {', '.join(__all__)}")
    return getattr(importlib.import_module(PUBLIC[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *PUBLIC])
