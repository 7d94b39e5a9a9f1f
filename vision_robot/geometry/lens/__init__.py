"""Lens models: from a point in front of the camera to the ideal image plane and back.

To add a model, write one file with a `Lens` and add its line to `LENSES`.
"""

from vision_robot.errors import BadParameter
from vision_robot.geometry.lens.brown import BROWN5, BROWN8
from vision_robot.geometry.lens.fisheye import FISHEYE
from vision_robot.geometry.lens.lens import Lens
from vision_robot.geometry.lens.pinhole import PINHOLE

__all__ = ["BROWN5", "BROWN8", "FISHEYE", "LENSES", "PINHOLE", "Lens", "lens_named"]

LENSES: dict[str, Lens] = {lens.name: lens for lens in (PINHOLE, BROWN5, BROWN8, FISHEYE)}


def lens_named(name: str) -> Lens:
    """The lens model of that name; raises BadParameter listing those that exist."""
    if name not in LENSES:
        raise BadParameter("camera model", name, f"one of {', '.join(LENSES)}")
    return LENSES[name]
