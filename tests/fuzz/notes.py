"""A note of a frame, as `vr synth` keeps them."""

from dataclasses import fields
from typing import Any

import numpy as np

from vision_robot.geometry import SE3
from vision_robot.sim.object_truth import ObjectTruth
from vision_robot_synth.making.frame_note import POSE, FrameNote

__all__ = ["frame_note"]

SHAPES = {
    "velocity": (2, 6),
    **dict.fromkeys(("centroid_px", "centre_px", "amodal_centroid_px", "axes_px"), (2, 2)),
    **dict.fromkeys(("amodal_box_px", "visible_box_px"), (2, 4)),
}


def frame_note() -> FrameNote:
    """Two things, one of them seen."""
    others = [one.name for one in fields(ObjectTruth) if one.name not in ("names", POSE)]
    arrays: dict[str, Any] = {name: np.ones(SHAPES.get(name, (2,))) for name in others}
    arrays["has_yaw"] = np.ones(2, dtype=bool)
    pose = SE3.from_rotvec(np.zeros((2, 3)), np.ones((2, 3)))
    return FrameNote(ObjectTruth(names=("rod", "ball"), **{POSE: pose}, **arrays), {1: [3, 4, 5]})
