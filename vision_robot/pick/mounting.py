"""Another arm in the cell: its tool turned as its fingers close, a place for the table, a pose aside."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from vision_robot.arm import read_arm
from vision_robot.arm.ik import InverseKinematics
from vision_robot.errors import BadArm, BadParameter, Unreachable
from vision_robot.geometry import SE3, SerialChain
from vision_robot.pick.goal import joints_for, station_from_grasp
from vision_robot.pick.world import World
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import ArmMount, CellDesign
from vision_robot.sim.fingers import Fingers
from vision_robot.types import Array, Float

__all__ = ["with_arm"]

HEIGHTS_M = (0.005, 0.08)
"""Heights of the tool over the table that the arm has to hold all over it."""

DISTANCES_M = np.arange(0.2, 1.01, 0.05)
LEVELS_M = (0.07, 0.0, 0.15, -0.15, 0.3)
"""Where the table is tried: ahead of the base, and above it."""


def with_arm(world: World, source: str, *, tool: str | None = None, base: str | None = None) -> World:
    """The world with the arm of an MJCF file; the table is put where the arm reaches it.

    Joint names, tool and fingers are found in the file. Raises BadArm for what cannot pick: no gripper,
    joints without position servos, fingers beside the tool; and for what reaches no table.
    """
    if Path(source).suffix.lower() not in (".xml", ".mjcf"):
        raise BadArm(source, "picking needs an MJCF file: a gripper's drive stands in no other")
    arm = read_arm(source, tool=tool, base=base or "world")
    if arm.tool not in _sites(source):
        raise BadArm(source, f"{arm.tool!r} is a body: mark the place between the fingers by a site")
    mount = ArmMount(Path(source), label=None, start=_middle(arm.chain), tool=arm.tool, balanced=True)
    fingers = _fingers(mount, source)
    turn = float(np.arctan2(fingers.closing[1], fingers.closing[0]))
    mount = replace(mount, tool_turn_rad=turn)
    arm = replace(arm, chain=_turned(arm.chain, turn))
    if _opening(mount, source) < 2e-3:
        raise BadArm(source, "its gripper does not open: the gap is below 2 mm at its widest")
    solver = InverseKinematics(arm)
    station = _table_for(solver, world, source)
    mount = replace(mount, start=tuple(_aside(solver, station).tolist()))
    return replace(world, arm=arm, design=replace(world.design, arm=mount, base_from_station=station))


def _sites(source: str) -> list[str]:
    from vision_robot.arm.mjcf import compiled

    model = compiled(Path(source))
    return [model.site(i).name for i in range(model.nsite)]


def _middle(chain: SerialChain) -> tuple[float, ...]:
    return tuple(np.mean(chain.limits, axis=1).tolist())


def _bare(mount: ArmMount, source: str) -> Cell:
    """A cell of the arm alone."""
    try:
        return Cell(CellDesign(arm=mount))
    except BadParameter as error:
        raise BadArm(source, str(error)) from error


def _fingers(mount: ArmMount, source: str) -> Fingers:
    cell = _bare(mount, source)
    fingers = cell.fingers
    if fingers is None or not np.isfinite(cell.opening_limits_m).all():
        raise BadArm(
            source,
            "it has no gripper: two fingers beyond the tool, each on a joint of its own, and an actuator "
            "that moves them",
        )
    joints = cell.joints
    try:
        cell.advance(0.0, joints=joints)
    except BadParameter as error:
        raise BadArm(source, f"its joints need position actuators: {error}") from error
    if fingers.tip_m < -0.005:
        short = f"{-1000 * fingers.tip_m:.0f} mm"
        raise BadArm(source, f"the fingers end {short} short of the tool {mount.tool!r}")
    return fingers


def _opening(mount: ArmMount, source: str) -> float:
    cell = _bare(mount, source)
    return float(cell.opening_limits_m[1])


def _turned(chain: SerialChain, turn_rad: float) -> SerialChain:
    """The chain whose tool is turned about its own z."""
    turn = SE3.from_rotvec(np.array([0.0, 0.0, turn_rad]), np.zeros(3))
    return replace(chain, wrist_from_tool=chain.wrist_from_tool @ turn)


def _table_for(solver: InverseKinematics, world: World, source: str) -> SE3:
    """A place ahead of the base where the arm reaches all of the table that is picked from.

    The middle one of those on a level, so that the arm is neither folded nor stretched.
    """
    for level in LEVELS_M:
        stations = [SE3(np.eye(3), np.array([float(ahead), 0.0, level])) for ahead in DISTANCES_M]
        reached = [one for one in stations if _reaches_all(solver, one, world)]
        if reached:
            return reached[len(reached) // 2]
    left, bottom, right, top = world.design.scatter_m
    size = f"{1000 * (right - left):.0f} x {1000 * (top - bottom):.0f} mm"
    raise BadArm(source, f"it reaches no table of {size} with its tool straight down")


def _reaches_all(solver: InverseKinematics, station: SE3, world: World) -> bool:
    left, bottom, right, top = world.design.scatter_m
    corners = [(x, y) for x in (left, right) for y in (bottom, top)]
    near = np.array(_middle(solver.arm.chain))
    try:
        for place in [*corners, world.place[:2]]:
            for height in HEIGHTS_M:
                for yaw in (0.0, np.pi / 2):
                    goal = station_from_grasp(np.array(place), yaw, height)
                    joints_for(solver, station, goal, near)
    except Unreachable:
        return False
    return True


def _aside(solver: InverseKinematics, station: SE3) -> Float[Array, "n"]:
    """Joint values that keep the arm out of the picture: over the table, then turned away at the base."""
    chain = solver.arm.chain
    goal = station_from_grasp(np.zeros(2), 0.0, HEIGHTS_M[1] + 0.1)
    near = np.array(_middle(chain))
    try:
        q = joints_for(solver, station, goal, near)
    except Unreachable:
        q = joints_for(solver, station, station_from_grasp(np.zeros(2), 0.0, HEIGHTS_M[1]), near)
    # The first joint that turns takes the whole arm away from the table.
    first = int(np.argmin(chain.slides))
    low, high = chain.limits[first]
    options = [q[first] + turn for turn in (1.9, -1.9, 2.6, -2.6, 1.4, -1.4)]
    inside = [value for value in options if low <= value <= high]
    if inside:
        q = q.copy()
        q[first] = inside[0]
    return q
