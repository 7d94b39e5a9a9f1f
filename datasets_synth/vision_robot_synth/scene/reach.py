"""What the arm is led through: a task as times, joint values and openings of the gripper."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import NoConvergence
from vision_robot.sim.cell import Cell
from vision_robot.types import Array, Float

__all__ = ["ArmCourse", "course_of", "joints_at"]

HOVER_M = 0.10
LIFT_M = 0.08
ASIDE_M = 0.14
"""How far from its place a picked thing is put down."""
SHORTEST_S, GRIP_S = 0.4, 1.2
"""Least time of a move; time in which the fingers close and have hold."""
SQUEEZE_M = 0.006
"""The servos are told to close so much further than the thing is wide."""
STEPS = 40
STARTS = 24
NEAR_M = 5e-4
NUDGE = 1e-5


@dataclass(frozen=True)
class ArmCourse:
    """Joint values and opening at rising times, evenly in between."""

    times_s: Float[Array, "m"]
    joints: Float[Array, "m n"]
    openings_m: Float[Array, "m"]

    def at(self, time_s: float) -> tuple[Float[Array, "n"], float]:
        """What the servos are to hold at a time."""
        joints = np.array([np.interp(time_s, self.times_s, column) for column in self.joints.T])
        return joints, float(np.interp(time_s, self.times_s, self.openings_m))


def course_of(
    cell: Cell, task: str, target: Float[Array, "3"], yaw_rad: float, speed_m_s: float, width_m: float
) -> ArmCourse:
    """The course of a task for a thing at `target` (x, y, z in {S}) that lies along `yaw_rad`.

    The fingers close across the thing. `cell` is used to try joint values and reset afterwards.
    """
    start, wide = cell.joints.copy(), cell.opening_limits_m[1]
    if task == "rest":
        return ArmCourse(np.array([0.0, 1.0]), np.stack([start, start]), np.full(2, wide))
    across = yaw_rad + np.pi / 2
    above, down = target + np.array([0, 0, HOVER_M]), target
    hover = joints_at(cell, above, across, start)
    grip = joints_at(cell, down, across, hover)
    stops = [(start, wide), (hover, wide), (grip, wide)]
    if task == "pick":
        closed = max(width_m - SQUEEZE_M, cell.opening_limits_m[0])
        goal = target + np.array([0.0, ASIDE_M if target[1] < 0 else -ASIDE_M, 0.0])
        up = np.array([0, 0, LIFT_M])
        lifted = joints_at(cell, target + up, across, grip)
        aside = joints_at(cell, goal + up, across, lifted)
        put = joints_at(cell, goal, across, aside)
        stops += [
            (grip, closed),
            (lifted, closed),
            (aside, closed),
            (put, closed),
            (put, wide),
            (aside, wide),
        ]
    times = [0.0]
    places = [_tool(cell, joints) for joints, _ in stops]
    for i in range(1, len(stops)):
        way = float(np.linalg.norm(places[i] - places[i - 1]))
        slow = 0.5 if i in (2, 6) else 1.0  # ways down are careful
        times.append(times[-1] + (GRIP_S if way == 0 else max(way / (slow * speed_m_s), SHORTEST_S)))
    cell.reset()
    joints = np.stack([joints for joints, _ in stops])
    return ArmCourse(np.array(times), joints, np.array([opening for _, opening in stops]))


def joints_at(
    cell: Cell, place: Float[Array, "3"], yaw_rad: float, near: Float[Array, "n"]
) -> Float[Array, "n"]:
    """Joint values that bring the tool there, pointing down, its x along `yaw_rad` in {S} or against it.

    Damped Gauss-Newton on the cell's own arm, from `near` and, where that leads nowhere, from anywhere.
    Raises NoConvergence where the arm does not reach.
    """
    rng = np.random.default_rng(0)
    low, high = cell.joint_limits.T
    for i in range(STARTS):
        start = near if i == 0 else low + rng.random(len(low)) * (high - low)
        found = [_descend(cell, place, yaw, start) for yaw in (yaw_rad, yaw_rad + np.pi)]
        reached = [q for q in found if q is not None]
        if reached:
            return min(reached, key=lambda q: float(np.abs(q - near).max()))
    raise NoConvergence(f"the arm does not reach {np.round(place, 3).tolist()} m in the station frame")


def _descend(
    cell: Cell, place: Float[Array, "3"], yaw: float, start: Float[Array, "n"]
) -> Float[Array, "n"] | None:
    low, high = cell.joint_limits.T
    q = start.copy()
    for _ in range(STEPS):
        error = _error(cell, q, place, yaw)
        if np.abs(error).max() < NEAR_M:
            return q
        J = np.stack(
            [(_error(cell, q + NUDGE * axis, place, yaw) - error) / NUDGE for axis in np.eye(len(q))], axis=1
        )
        step = np.linalg.solve(J.T @ J + 1e-6 * np.eye(len(q)), -J.T @ error)
        q = np.clip(q + step * min(1.0, 0.5 / max(float(np.abs(step).max()), 1e-12)), low, high)
    return None


def _error(cell: Cell, q: Float[Array, "n"], place: Float[Array, "3"], yaw: float) -> Float[Array, "9"]:
    """Tool point [m], its z against straight down and its x against the yaw, 0.1 m away from the point."""
    cell.pose_arm(q)
    pose = cell.station_from_tool
    along = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    down = pose.rotation[:, 2] + np.array([0, 0, 1])
    return np.concatenate([pose.translation - place, 0.1 * down, 0.1 * (pose.rotation[:, 0] - along)])


def _tool(cell: Cell, q: Float[Array, "n"]) -> Float[Array, "3"]:
    cell.pose_arm(q)
    return cell.station_from_tool.translation
