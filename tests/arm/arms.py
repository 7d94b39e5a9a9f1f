"""Arms of several kinds: published ones, and ones with awkward bases and tools."""

import numpy as np

from vision_robot.geometry import SE3, SerialChain
from vision_robot_synth.published_arms import PANDA, PUMA_560, UR5E, modified_dh, standard_dh

__all__ = [
    "PANDA",
    "PUMA_560",
    "UR5E",
    "column_elbow",
    "modified_dh",
    "rail_elbow",
    "standard_dh",
    "waist_elbow",
]


def _along(axes: list[list[float]], points: list[list[float]], slides: list[bool], tool: SE3) -> SerialChain:
    """A chain whose joint frames are parallel to the base at zero, turned by an arbitrary placement."""
    placed = SE3.from_rotvec(np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.2, 0.3]))
    steps = np.diff(np.array([[0.0, 0, 0], *points]), axis=0)
    links = SE3(np.tile(np.eye(3), (len(steps), 1, 1)), steps)
    first = placed @ links[0]
    n = len(axes)
    turning = np.array([[-170.0, 170.0]] * n)
    limits = np.radians(turning)
    limits[np.array(slides)] = [-0.4, 0.4]
    return SerialChain(
        joint_names=tuple(f"q{i + 1}" for i in range(n)),
        slides=np.array(slides),
        axes=np.array(axes, dtype=float),
        link_from_joint=SE3(
            np.concatenate([first.rotation[None], links.rotation[1:]]),
            np.concatenate([first.translation[None], links.translation[1:]]),
        ),
        last_from_wrist=SE3.identity(),
        limits=limits,
        wrist_from_tool=tool,
    )


TOOL = SE3.from_rotvec(np.array([0.2, 1.0, -0.4]), np.array([0.03, -0.02, 0.12]))
X, Y, Z = [1.0, 0, 0], [0.0, 1, 0], [0.0, 0, 1]


def column_elbow() -> SerialChain:
    """Column, waist, shoulder, elbow, roll, with offsets and a crooked tool."""
    points = [[0.0, 0, 0.2], [0.02, 0.01, 0.2], [0.05, 0.04, 0.25], [0.35, 0.02, 0.25], [0.55, 0.03, 0.24]]
    return _along([Z, Z, Y, [0, -1, 0], X], points, [True] + [False] * 4, TOOL)


def rail_elbow() -> SerialChain:
    """Rail, shoulder, elbow, wrist pitch, roll."""
    points = [[0.0, 0, 0.2], [0.02, 0.01, 0.2], [0.3, 0.04, 0.25], [0.55, 0.02, 0.25], [0.60, 0.03, 0.24]]
    return _along([Y, Y, [0, -1, 0], Y, X], points, [True] + [False] * 4, TOOL)


def waist_elbow() -> SerialChain:
    """Waist, shoulder, elbow, wrist pitch, roll."""
    points = [[0.0, 0, 0.1], [0.02, 0.01, 0.2], [0.3, 0.04, 0.25], [0.55, 0.02, 0.25], [0.60, 0.03, 0.24]]
    return _along([Z, Y, [0, -1, 0], Y, X], points, [False] * 5, TOOL)
