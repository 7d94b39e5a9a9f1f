"""A robot cell that runs: table, items, belt and arm in MuJoCo, with their true poses in {S}."""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot.sim.cell_design import CellDesign, Item
from vision_robot.sim.cell_model import build
from vision_robot.sim.cell_names import ARM, BELT, ITEM, LABEL, LABEL_THICKNESS_M
from vision_robot.sim.drive import Drive
from vision_robot.sim.fingers import Fingers, fingers_of
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.placing import quaternion, resting
from vision_robot.sim.scatter import scattered
from vision_robot.sim.shapes import Shape, shape_named
from vision_robot.sim.surfaces import BELT_PITCH_M
from vision_robot.sim.surroundings import SKY_SHARE, direction
from vision_robot.types import Array, Float

__all__ = ["Cell"]

MjModel: TypeAlias = Any
MjData: TypeAlias = Any

OUT_OF_THE_WAY = (0.2, 1.9, 0.5, 0.0, 0.0)
"""Where the project's own arm waits: beside the table's middle, out of an ordinary camera's picture."""


class Cell:
    """A `CellDesign` brought to life; needs no OpenGL.

    Time goes on by `advance` (physics: free items fall, roll, are pushed and grasped; the arm
    follows its servos) or is set by `at` (only what has a path moves, exactly and without physics).
    `tracked` names what the truth tells about; the id of each is its place there, from 1.
    The same design and the same calls give the same motion, bit for bit.
    """

    def __init__(self, design: CellDesign):
        self._mujoco = mj = load_mujoco(rendering=False)
        self.design = design
        self.model: MjModel = build(design)
        self.data: MjData = mj.MjData(self.model)
        self._items = {item.name: item for item in design.items}
        self._paths = [
            (item, int(self.model.body(ITEM + item.name).mocapid[0]), item.path)
            for item in design.items
            if item.path is not None
        ]
        self._lights = self._lights_now()
        self._watch: tuple[float, Callable[[], None]] | None = None
        self._next_watch_s = 0.0
        self._drive = Drive.of(mj, self.model, ARM)
        labelled = design.arm is not None and design.arm.label is not None
        names = [item.name for item in design.items if item.tracked]
        self.tracked: tuple[str, ...] = (*names, *((LABEL,) if labelled else ()))
        self.base_from_station = design.base_from_station
        self._station_from_base = design.base_from_station.inverse()
        self.bodies = np.array([self._body(name) for name in self.tracked], dtype=int)
        """MuJoCo's body of each tracked thing."""
        shapes = [self._shape(name) for name in self.tracked]
        self.hulls = [shape.hull for shape in shapes]
        """Corners of each tracked thing's convex hull, in its own frame [m]."""
        self.has_yaw = np.array([shape.has_yaw for shape in shapes], dtype=bool)
        """Whether its turning about {S}'s z can be seen."""
        self.reset()

    # ------------------------------------------------------------------ time

    @property
    def time_s(self) -> float:
        """Seconds since the reset."""
        return float(self.data.time)

    def reset(self, seed: int | None = None) -> None:
        """Back to the start; with a seed the free items are scattered over `design.scatter_m`."""
        self._mujoco.mj_resetData(self.model, self.data)
        if self.design.arm is not None:
            start = self.design.arm.start
            if start is None and self.design.arm.mjcf is None:
                start = OUT_OF_THE_WAY
            drive = self._arm()
            drive.put(self.data, drive.joints(self.data) if start is None else np.array(start))
            widest = drive.opening_limits_m(self.model)[1]
            if np.isfinite(widest):
                drive.put_opening(self.model, self.data, widest)
        if seed is not None:
            free = [item for item in self.design.items if item.path is None and not item.fixed]
            still = [item for item in self.design.items if item not in free]
            for item in scattered(free, self.design.scatter_m, np.random.default_rng(seed), around=still):
                place = np.array([item.x_m, item.y_m, item.above_m, item.yaw_rad])
                self._put_free(item, resting(item, place))
        self._settle_kinematics()

    def advance(
        self, seconds: float, *, joints: Float[Array, "n"] | None = None, opening_m: float | None = None
    ) -> None:
        """Let physics run; `joints` and `opening_m` are what the servos hold from now on."""
        if joints is not None or opening_m is not None:
            self._arm().command(self.data, joints, opening_m)
        self._run(seconds)

    def follow(
        self,
        times_s: Float[Array, "m"],
        joints: Float[Array, "m n"],
        openings_m: Float[Array, "m"] | None = None,
    ) -> None:
        """Let physics run while the servos are led through the rows of `joints`, evenly in between.

        `times_s` count from now; the run ends with the last of them.
        """
        times, rows = np.asarray(times_s, dtype=float), np.asarray(joints, dtype=float)
        if rows.ndim != 2 or times.shape != rows.shape[:1] or not (np.diff(times) > 0).all() or times[0] < 0:
            raise BadParameter(
                "joint trajectory", (times.shape, rows.shape), "rising times from 0, a row of joints for each"
            )
        drive, steps = self._arm(), self._steps(times[-1])
        for i in range(steps):
            now = times[-1] * (i + 1) / steps
            target = np.array([np.interp(now, times, column) for column in rows.T])
            gap = None if openings_m is None else float(np.interp(now, times, openings_m))
            drive.command(self.data, target, gap)
            self._step(times[-1] / steps)
        self._settle_kinematics()

    def at(self, time_s: float) -> None:
        """Set the time: everything with a path, and the belt's picture, is where it is then. No physics."""
        self.data.time = time_s
        self._settle_kinematics()

    def watch(self, period_s: float, look: Callable[[], None] | None) -> None:
        """Have `look` called after each `period_s` of physics from now on, None ends it: what films the cell.

        It may read everything and must move nothing.
        """
        if not period_s > 0:
            raise BadParameter("period of a watch", period_s, "positive")
        self._watch = None if look is None else (period_s, look)
        self._next_watch_s = self.time_s + period_s

    def _steps(self, seconds: float) -> int:
        if not (np.isfinite(seconds) and seconds >= 0):
            raise BadParameter("seconds", seconds, "zero or more")
        return int(np.ceil(seconds / self.design.timestep_s - 1e-9))

    def _run(self, seconds: float) -> None:
        steps = self._steps(seconds)
        for _ in range(steps):
            self._step(seconds / steps)
        self._settle_kinematics()

    def _step(self, seconds: float) -> None:
        # Steps are shortened so that a whole number of them ends at the time asked for.
        self.model.opt.timestep = seconds
        self._move_paths()
        self._mujoco.mj_step(self.model, self.data)
        if self._watch is not None and self.time_s >= self._next_watch_s - 1e-9:
            self._next_watch_s += self._watch[0]
            self._watch[1]()

    def _move_paths(self) -> None:
        for item, mocap, path in self._paths:
            pose = self.base_from_station @ resting(item, path.at(self.time_s))
            self.data.mocap_pos[mocap] = pose.translation
            self.data.mocap_quat[mocap] = quaternion(pose.rotation)

    def _settle_kinematics(self) -> None:
        """Poses and velocities of this very moment: `mj_step` leaves those before the last step."""
        mj, model, data = self._mujoco, self.model, self.data
        self._move_paths()
        belt = self.design.belt
        if belt is not None:
            gone = np.mod(belt.speed_m_s * self.time_s, BELT_PITCH_M)
            middle = np.array([belt.x_m, self.design.table.middle_m[1] + gone, model.geom(BELT).pos[2]])
            mocap = int(model.body(BELT).mocapid[0])
            data.mocap_pos[mocap] = self.base_from_station.apply(middle[None])[0]
        mj.mj_kinematics(model, data)
        mj.mj_comPos(model, data)
        mj.mj_camlight(model, data)
        mj.mj_tendon(model, data)
        mj.mj_transmission(model, data)
        mj.mj_comVel(model, data)

    # ------------------------------------------------------------------ the arm

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The arm's joints from the base out."""
        return self._arm().joint_names

    @property
    def joint_limits(self) -> Float[Array, "n 2"]:
        """Least and greatest value of each joint [m, rad]."""
        return self._arm().limits

    @property
    def joints(self) -> Float[Array, "n"]:
        """True joint values [m, rad]."""
        return self._arm().joints(self.data)

    @property
    def joint_rates(self) -> Float[Array, "n"]:
        """True joint velocities [m/s, rad/s]."""
        return self._arm().rates(self.data)

    @property
    def opening_m(self) -> float:
        """True gap between the fingers."""
        return self._arm().opening_m(self.data)

    @property
    def opening_limits_m(self) -> tuple[float, float]:
        """Least and greatest gap that can be commanded."""
        return self._arm().opening_limits_m(self.model)

    @property
    def fingers(self) -> Fingers | None:
        """The gripper's fingers as they stand; None where there are none."""
        return fingers_of(self.model, self.data, ARM, self._arm().joint_ids)

    @property
    def base_from_tool(self) -> SE3:
        """True pose of the tool {T} in {B}."""
        self._arm()
        site = self.data.site(ARM + "tool")
        return SE3(site.xmat.reshape(3, 3).copy(), site.xpos.copy())

    @property
    def station_from_tool(self) -> SE3:
        """True pose of the tool {T} in {S}."""
        return self._station_from_base @ self.base_from_tool

    def pose_arm(
        self,
        joints: Float[Array, "n"],
        *,
        opening_m: float | None = None,
        rates: Float[Array, "n"] | None = None,
    ) -> None:
        """Put the arm there at once, without physics; `rates` are the velocities the truth shall tell."""
        drive = self._arm()
        drive.put(self.data, joints, rates)
        if opening_m is not None:
            drive.put_opening(self.model, self.data, opening_m)
        self._settle_kinematics()

    def _arm(self) -> Drive:
        if self._drive is None:
            raise BadParameter("cell", "without an arm", "built with CellDesign(arm=ArmMount())")
        return self._drive

    # ------------------------------------------------------------------ the items

    def station_from(self, name: str) -> SE3:
        """True pose of a thing in {S}; the label's own frame is at its middle, z out of it."""
        body = self.data.body(self._body(name))
        return self._station_from_base @ SE3(body.xmat.reshape(3, 3).copy(), body.xpos.copy())

    def station_from_tracked(self) -> SE3:
        """True poses of all tracked things in {S}, a batch."""
        R, t = self.data.xmat[self.bodies].reshape(-1, 3, 3), self.data.xpos[self.bodies]
        return self._station_from_base @ SE3(R, t)

    def base_from_bodies(self) -> SE3:
        """True poses of all bodies of the model in {B}; the belt's as if its picture never jumped back."""
        R, t = self.data.xmat.reshape(-1, 3, 3).copy(), self.data.xpos.copy()
        belt = self.design.belt
        if belt is not None:
            jumped = belt.speed_m_s * self.time_s - np.mod(belt.speed_m_s * self.time_s, BELT_PITCH_M)
            t[int(self.model.body(BELT).id)] += self.base_from_station.rotation @ [0.0, jumped, 0.0]
        return SE3(R, t)

    def velocity(self, name: str) -> Float[Array, "6"]:
        """True velocity of its middle [m/s], then angular velocity [rad/s], both in axes of {S}."""
        item = self._items.get(name)
        if item is not None and item.path is not None:
            x, y, z, yaw = item.path.rate(self.time_s)
            return np.array([x, y, z, 0, 0, yaw])
        mj, result = self._mujoco, np.zeros(6)
        mj.mj_objectVelocity(self.model, self.data, mj.mjtObj.mjOBJ_XBODY.value, self._body(name), result, 0)
        R = self._station_from_base.rotation
        return np.concatenate([R @ result[3:], R @ result[:3]])

    def place(self, name: str, station_from_item: SE3, velocity: Float[Array, "6"] | None = None) -> None:
        """Put a free item there, at rest or moving (velocity as `velocity` gives it)."""
        item = self._items.get(name)
        if item is None or item.fixed or item.path is not None:
            free = [i.name for i in self.design.items if i.path is None and not i.fixed]
            raise BadParameter("item to place", name, f"a free one: {', '.join(free) or 'there is none'}")
        self._put_free(item, station_from_item)
        if velocity is not None:
            # MuJoCo has a free body's linear velocity in axes of the world, its angular in its own.
            linear, angular = np.asarray(velocity[:3]), np.asarray(velocity[3:])
            R = self.base_from_station.rotation
            self.data.joint(ITEM + name).qvel[:] = [*(R @ linear), *(station_from_item.rotation.T @ angular)]
        self._settle_kinematics()

    def set_light(
        self,
        *,
        key: float | None = None,
        ambient: float | None = None,
        azimuth_rad: float | None = None,
        elevation_rad: float | None = None,
    ) -> None:
        """Change the lights from now on (see `Lights`); None leaves a value as the design has it."""
        lights, model = self.design.lights, self.model
        sun, sky = model.light("key").id, model.light("sky").id
        if key is not None:
            model.light_diffuse[sun], model.light_specular[sun] = key, 0.5 * key
        if ambient is not None:
            model.light_diffuse[sky] = SKY_SHARE * ambient
            model.light_ambient[sky] = (1 - SKY_SHARE) * ambient
        if azimuth_rad is not None or elevation_rad is not None:
            azimuth = lights.azimuth_rad if azimuth_rad is None else azimuth_rad
            elevation = lights.elevation_rad if elevation_rad is None else elevation_rad
            towards = self.base_from_station.rotation @ direction(azimuth, elevation)
            model.light_pos[sun] = self.base_from_station.translation + 1.6 * towards
            model.light_dir[sun] = -towards
        self._mujoco.mj_camlight(model, self.data)

    @property
    def light_is_as_designed(self) -> bool:
        """Whether the lights are those of the design."""
        return bool((self._lights == self._lights_now()).all())

    def _lights_now(self) -> Array:
        m = self.model
        return np.stack([m.light_diffuse, m.light_ambient, m.light_specular, m.light_dir, m.light_pos])

    def _put_free(self, item: Item, station_from_item: SE3) -> None:
        pose = self.base_from_station @ station_from_item
        joint = self.data.joint(ITEM + item.name)
        joint.qpos[:] = [*pose.translation, *quaternion(pose.rotation)]
        joint.qvel[:] = 0

    def _shape(self, name: str) -> Shape:
        item = self._items.get(name)
        if item is not None:
            return shape_named(item.shape, item.size_m, item.colour)
        assert self.design.arm is not None
        assert self.design.arm.label is not None
        return shape_named("box", (*self.design.arm.label_m, LABEL_THICKNESS_M), self.design.arm.label)

    def _body(self, name: str) -> int:
        if name == LABEL and name not in self._items and LABEL in self.tracked:
            return int(self.model.body(ARM + LABEL).id)
        if name not in self._items:
            known = sorted({*self._items, *self.tracked})
            raise BadParameter("name", name, f"one of {', '.join(known) or 'none: the cell is empty'}")
        return int(self.model.body(ITEM + name).id)
