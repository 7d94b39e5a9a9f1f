"""Vision Robot: from camera to grasp, with numbers for how good every step is."""

import importlib
import os
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vision_robot.calibrate import CalibrationResult as CalibrationResult
    from vision_robot.calibrate import Corners as Corners
    from vision_robot.calibrate import Settings as Settings
    from vision_robot.calibrate.boards import board_named as board_named
    from vision_robot.calibrate.detect import detect_boards as detect_boards
    from vision_robot.calibrate.judgement import judge as judge
    from vision_robot.formats import read_camera as read_camera
    from vision_robot.formats import write_camera as write_camera
    from vision_robot.geometry import SE3 as SE3
    from vision_robot.geometry import Camera as Camera
    from vision_robot.images import open_images as open_images

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
    "Settings": "vision_robot.calibrate",
    "board_named": "vision_robot.calibrate.boards",
    "detect_boards": "vision_robot.calibrate.detect",
    "judge": "vision_robot.calibrate.judgement",
    "open_images": "vision_robot.images",
    "read_camera": "vision_robot.formats",
    "write_camera": "vision_robot.formats",
}

__all__ = [
    "SE3",
    "CalibrationResult",
    "Camera",
    "Corners",
    "Settings",
    "board_named",
    "detect_boards",
    "judge",
    "open_images",
    "read_camera",
    "write_camera",
]


def __getattr__(name: str) -> Any:
    if name not in PUBLIC:
        raise AttributeError(f"module 'vision_robot' has no attribute {name!r}; it has {', '.join(__all__)}")
    return getattr(importlib.import_module(PUBLIC[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *PUBLIC])
