"""Vision Robot: from camera to grasp, with numbers for how good every step is."""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vision_robot.calibrate.corners import Corners as Corners
    from vision_robot.geometry import SE3 as SE3
    from vision_robot.geometry import Camera as Camera

__version__ = "0.1.0"

# The public face: each name is imported when it is first used, so that `import vision_robot` costs nothing.
PUBLIC = {
    "SE3": "vision_robot.geometry",
    "Camera": "vision_robot.geometry",
    "Corners": "vision_robot.calibrate.corners",
}

__all__ = ["SE3", "Camera", "Corners"]


def __getattr__(name: str) -> Any:
    if name not in PUBLIC:
        raise AttributeError(f"module 'vision_robot' has no attribute {name!r}; it has {', '.join(__all__)}")
    return getattr(importlib.import_module(PUBLIC[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *PUBLIC])
