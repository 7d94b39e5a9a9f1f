"""Where the tool has to be to take an object, and the joints that bring it there."""

import numpy as np

from vision_robot.arm import base_from_tool
from vision_robot.arm.ik import InverseKinematics
from vision_robot.errors import Unreachable
from vision_robot.geometry import SE3, rotation_exp
from vision_robot.types import Array, Float

__all__ = ["joints_for", "station_from_grasp", "upright"]

DOWN = np.array([0.0, 0.0, -1.0])

SHORT_M, TURNED_RAD = 1e-4, 0.01
"""What an arm measured to be a little off its drawing may lack of a pose that its drawing reaches."""


def station_from_grasp(position_m: Float[Array, "2"], yaw_rad: float, height_m: float) -> SE3:
    """station_from_goal of a tool that points straight down over an axis of direction `yaw_rad`.

    The tool's x, in which the fingers close, lies across the axis, its y along it, its z down.
    """
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    R = np.array([[-s, c, 0.0], [c, s, 0.0], [0.0, 0.0, -1.0]])
    return SE3(R, np.array([*position_m, height_m]))


def joints_for(
    solver: InverseKinematics,
    base_from_station: SE3,
    station_from_goal: SE3,
    near: Float[Array, "n"],
    *,
    back_towards_m: Float[Array, "2"] | None = None,
) -> Float[Array, "n"]:
    """Joint values nearest to `near` for the goal or the goal turned by half a turn, since fingers are alike.

    With `back_towards_m`, a place of {S}, that one of the two is taken whose back (-y, where a label hangs)
    faces it more. The tool is held upright in {B}: five joints cannot follow the slight tilt that a measured
    station has. Raises Unreachable, with how far the nearest pose is away.
    """
    goal = upright(base_from_tool(base_from_station, station_from_goal))
    turned = goal @ SE3.from_rotvec(np.array([0.0, 0.0, np.pi]), np.zeros(3))
    both = SE3(np.stack([goal.rotation, turned.rotation]), np.stack([goal.translation, turned.translation]))
    found = solver.solve(both, near=near)
    near_enough = (found.position_error_m < SHORT_M) & (found.orientation_error_rad < TURNED_RAD)
    if not near_enough.any():
        raise Unreachable(station_from_goal.translation.tolist(), float(found.position_error_m.min()))
    cost = np.abs(found.q - near).max(axis=1)
    if back_towards_m is not None:
        away = back_towards_m - station_from_goal.translation[:2]
        facing = float(-station_from_goal.rotation[:2, 1] @ away)
        cost = np.array([-facing, facing])
    return found.q[int(np.argmin(np.where(near_enough, cost, np.inf)))]


def upright(base_from_tool: SE3) -> SE3:
    """The tool turned by the least angle that makes it point straight down in {B}."""
    z = base_from_tool.rotation[:, 2]
    axis = np.cross(z, DOWN)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-12:
        return base_from_tool
    turn = rotation_exp(axis / sine * np.arctan2(sine, float(z @ DOWN)))
    return SE3(turn @ base_from_tool.rotation, base_from_tool.translation)
