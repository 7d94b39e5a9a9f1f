"""Arms, cameras and boards of synthetic hand-eye sets: where things are mounted, and the true links."""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, SerialChain, rotation_exp

__all__ = ["CELLS", "HandEyeCell", "cell_named", "with_link_errors"]


@dataclass(frozen=True)
class HandEyeCell:
    """An arm and where camera and board sit: on the wrist or at the base, one of each."""

    arm: SerialChain
    mount_from_cam: SE3
    far_from_board: SE3


def cell_named(arm: str, setup: str) -> HandEyeCell:
    """The cell of that arm (`column`, `six-axis`) and set-up; raises BadParameter listing what there is."""
    if (arm, setup) not in CELLS:
        raise BadParameter("synthetic cell", f"{arm}, {setup}", f"one of {', '.join(map(', '.join, CELLS))}")
    chain = _column() if arm == "column" else _six_axis()
    mount, far = CELLS[arm, setup]
    return HandEyeCell(chain, mount, far)


def with_link_errors(arm: SerialChain, turn: float, shift_m: float, rng: np.random.Generator) -> SerialChain:
    """The same arm as it was really built: each link off by that much per axis, one sigma [rad, m]."""
    n = len(arm)
    errors = SE3(rotation_exp(turn * rng.normal(size=(n, 3))), shift_m * rng.normal(size=(n, 3)))
    return replace(arm, link_from_joint=arm.link_from_joint @ errors)


def _column() -> SerialChain:
    from vision_robot.arm import read_arm

    return read_arm("column").chain


def _six_axis() -> SerialChain:
    """Six hinges in the usual order, 0.9 m of reach: waist, shoulder, elbow, and a wrist of three axes."""
    places = [(0, 0, 0.15), (0, 0, 0.1), (0, 0, 0.4), (0, 0, 0.15), (0, 0, 0.25), (0, 0, 0.08)]
    axes = [(0, 0, 1), (0, 1, 0), (0, 1, 0), (0, 0, 1), (0, 1, 0), (0, 0, 1)]
    limits = np.radians([[-170, 170], [-60, 120], [-30, 150], [-180, 180], [-120, 120], [-180, 180]])
    return SerialChain(
        joint_names=tuple(f"j{i}" for i in range(1, 7)),
        slides=np.zeros(6, dtype=bool),
        axes=np.array(axes, dtype=float),
        link_from_joint=SE3(np.broadcast_to(np.eye(3), (6, 3, 3)), np.array(places, dtype=float)),
        last_from_wrist=SE3(np.eye(3), np.array([0.0, 0, 0.06])),
        limits=limits,
        wrist_from_tool=SE3(np.eye(3), np.array([0.0, 0, 0.12])),
    )


def _pose(turn_deg: tuple[float, float, float], place_m: tuple[float, float, float]) -> SE3:
    return SE3.from_rotvec(np.radians(turn_deg), np.array(place_m))


def _looking(eye_m: tuple[float, float, float], target_m: tuple[float, float, float]) -> SE3:
    """A camera, or a board, at `eye_m` whose z points at `target_m` and whose x is level."""
    z = np.subtract(target_m, eye_m) / np.linalg.norm(np.subtract(target_m, eye_m))
    x = np.cross(z, [0, 0, 1.0])
    x /= np.linalg.norm(x)
    return SE3(np.stack([x, np.cross(z, x), z], axis=1), np.array(eye_m))


ON_WRIST = _pose((4.0, -3.0, 88.0), (0.055, 0.012, 0.035))
"""A camera beside the gripper that looks along the fingers, not quite straight."""

ON_TABLE = _pose((180.0, 0.0, 0.0), (0.30, 0.06, 0.0))
"""A board face up on the table: its z goes down."""

CARRIED = SE3(
    np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]) @ rotation_exp(np.array([0.05, -0.04, 0.02])),
    np.array([-0.03, -0.09, 0.04]),
)
"""A board held by the hand, its face to one side of the fingers."""

CELLS = {
    ("column", "eye-in-hand"): (ON_WRIST, ON_TABLE),
    ("column", "eye-to-hand"): (_looking((0.45, -0.85, 0.55), (0.40, 0.0, 0.25)), CARRIED),
    ("six-axis", "eye-in-hand"): (ON_WRIST, _pose((180.0, 0.0, 0.0), (0.45, 0.06, 0.0))),
    ("six-axis", "eye-to-hand"): (_looking((0.55, -0.95, 0.65), (0.40, 0.0, 0.45)), CARRIED),
}
"""Arm and set-up: where the camera sits on its end, where the board on the other."""
