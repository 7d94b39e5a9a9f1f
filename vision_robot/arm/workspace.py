"""Where an arm reaches with its tool pointing down, and how well it moves there."""

from dataclasses import dataclass

import numpy as np

from vision_robot.arm.ik import InverseKinematics
from vision_robot.geometry import SE3
from vision_robot.types import Array, Bool, Float

__all__ = ["Slice", "Workspace", "manipulability", "tool_down", "workspace"]


@dataclass(frozen=True)
class Slice:
    """A plane of the workspace: a grid of places, whether each is reached, how well the tool moves there."""

    across_m: Float[Array, "columns"]
    up_m: Float[Array, "rows"]
    reached: Bool[Array, "rows columns"]
    manipulability: Float[Array, "rows columns"]
    """Yoshikawa's measure of the tool's position; NaN where not reached."""


@dataclass(frozen=True)
class Workspace:
    """The slice seen from above at one height, and the upright slice through the base along x."""

    level: Slice
    height_m: float
    upright: Slice


def tool_down(yaw_rad: Float[Array, "*batch"]) -> Float[Array, "*batch 3 3"]:
    """Orientations of a tool that points down: z along -z of the base, x at yaw from the base's x."""
    yaw = np.asarray(yaw_rad, dtype=float)
    c, s, o = np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)
    return np.stack([c, s, o, s, -c, o, o, o, o - 1], axis=-1).reshape(*yaw.shape, 3, 3)


def manipulability(jacobian: Float[Array, "*rows 6 n"]) -> Float[Array, "*rows"]:
    """sqrt(det(J J^T)) of the tool's position (Yoshikawa 1985): zero where it cannot move some way."""
    J = jacobian[..., :3, :]
    return np.sqrt(np.maximum(np.linalg.det(J @ np.swapaxes(J, -1, -2)), 0.0))


def workspace(ik: InverseKinematics, *, height_m: float | None = None, cells: int = 121) -> Workspace:
    """Both slices of the workspace with the tool down; without a height the one that most places share.

    `ik` must be for poses. The tool's x points away from the base's z axis; yaw is free for whatever the
    last joint turns about the tool, and else this is the yaw that is asked.
    """
    chain, reach = ik.arm.chain, ik.arm.reach_m
    at_middle = chain.base_from_tool(chain.limits.mean(axis=1)).translation
    origin = chain.base_from_joints(np.zeros(len(chain)))[0].translation
    travel = np.diff(chain.limits[chain.slides], axis=1).sum()
    span = 1.05 * reach
    across = np.linspace(-span, span, cells)
    up = np.linspace(
        min(origin[2], at_middle[2]) - travel - reach, max(origin[2], at_middle[2]) + travel + reach, cells
    )
    x, z = np.meshgrid(across, up)
    upright = _slice(ik, across, up, origin + np.stack([x, 0 * x, z - origin[2]], axis=-1), origin)
    if height_m is None:
        filled = upright.reached.sum(axis=1)
        widest = np.flatnonzero(filled == filled.max())
        height_m = float(up[widest[len(widest) // 2]])
    x, y = np.meshgrid(across, across)
    level_places = np.stack([origin[0] + x, origin[1] + y, np.full_like(x, height_m)], axis=-1)
    return Workspace(_slice(ik, across, across, level_places, origin), height_m, upright)


def _slice(
    ik: InverseKinematics,
    across: Float[Array, "columns"],
    up: Float[Array, "rows"],
    places: Float[Array, "rows columns 3"],
    origin: Float[Array, "3"],
) -> Slice:
    flat = places.reshape(-1, 3)
    yaw = np.arctan2(flat[:, 1] - origin[1], flat[:, 0] - origin[0])
    goals = SE3(tool_down(yaw), flat)
    q, reached = ik.sketch(goals)
    value = np.where(reached, manipulability(ik.arm.chain.jacobian(q)), np.nan)
    shape = places.shape[:2]
    return Slice(across, up, reached.reshape(shape), value.reshape(shape))
