"""The arm of a cell played through its moves: through joint offsets and backlash to the servos."""

import numpy as np

from vision_robot.arm.ik import InverseKinematics
from vision_robot.arm.paths import follow, line
from vision_robot.arm.ramp import ramp
from vision_robot.arm.timing import Trajectory, timed
from vision_robot.geometry import SE3
from vision_robot.pick.world import World
from vision_robot.sim.cell import Cell
from vision_robot.types import Array, Float

__all__ = ["Player"]

SPEED, PUSH = np.array([0.5, 2.0, 2.0, 3.0, 4.0]), np.array([2.0, 8.0, 8.0, 15.0, 20.0])
"""Joint velocities and accelerations of the column arm [m, rad, s]; others take the first for slides."""

GENTLY = 0.35
"""Share of the speed near objects."""

PERIOD_S = 0.01
"""Between two rows of joint values sent to the servos."""

SETTLE_S = 0.15


class Player:
    """Moves the arm; knows only what the encoders tell."""

    def __init__(self, cell: Cell, world: World, solver: InverseKinematics):
        self.cell, self.world, self.solver = cell, world, solver
        self.phase = ""
        """What the arm is doing, in a word or two: for who watches."""
        self.remark = ""
        """What was found on the way, for who watches."""
        self._told = world.told_joints(cell.joints)
        self._side = np.zeros(len(self._told))
        slides = world.arm.chain.slides
        n = len(slides)
        self._speed = SPEED if n == len(SPEED) else np.where(slides, 0.5, 2.0)
        self._push = PUSH if n == len(PUSH) else np.where(slides, 2.0, 8.0)

    @property
    def joints(self) -> Float[Array, "n"]:
        """Joint values as they were last told."""
        return self._told

    def move_to(self, joints: Float[Array, "n"], *, share: float = 1.0) -> None:
        """Straight in joint space, from rest to rest."""
        self._play(self._timed(np.stack([self._told, joints]), share))

    def move_along(self, start: SE3, end: SE3, *, share: float = GENTLY) -> None:
        """The tool along a straight line in {B}; raises BadPath where the arm cannot hold it."""
        path = follow(self.solver, line(start, end), near=self._told)
        self._play(self._timed(np.concatenate([self._told[None], path.q[1:]]), share))

    def servo(self, joints: Float[Array, "n"], seconds: float) -> None:
        """Send one set of joint values to the servos, and let that much time go by."""
        pair = self._with_play(self.world.real_joints(np.stack([self._told, joints])))
        self._told = joints
        self.cell.advance(seconds, joints=pair[1])

    def track(
        self,
        times_s: Float[Array, "m"],
        joints: Float[Array, "m n"],
        openings_m: Float[Array, "m"] | None = None,
    ) -> None:
        """Lead the servos through rows of joint values at times from now, and the fingers with them."""
        rows = np.concatenate([self._told[None], joints])
        self.cell.follow(times_s, self._with_play(self.world.real_joints(rows))[1:], openings_m)
        self._told = joints[-1]

    def seconds_to(self, joints: Float[Array, "n"]) -> float:
        """How long `move_to` would take."""
        return self._timed(np.stack([self._told, joints]), 1.0).seconds + SETTLE_S

    def grip(self, opening_m: float, *, seconds: float = 0.5) -> None:
        """Move the fingers to that gap, or until something is between them."""
        self.cell.advance(seconds, opening_m=opening_m)

    def hold(self, seconds: float) -> None:
        """Stand still."""
        self.cell.advance(seconds)

    def _timed(self, q: Float[Array, "points n"], share: float) -> Trajectory:
        names, speed, push = self.world.arm.chain.joint_names, share * self._speed, share * self._push
        if len(q) == 2:
            return ramp(names, q[0], q[1], velocity=speed, acceleration=push)
        return timed(names, q, velocity=speed, acceleration=push)

    def _play(self, motion: Trajectory) -> None:
        count = max(2, int(np.ceil(motion.seconds / PERIOD_S)) + 1)
        times = np.linspace(0, max(motion.seconds, PERIOD_S), count)
        told = motion.at(times) if motion.seconds > 0 else np.repeat(motion.q, count, axis=0)
        self.cell.follow(times, self._with_play(self.world.real_joints(told)))
        self._told = told[-1]
        self.cell.advance(SETTLE_S)

    def _with_play(self, real: Float[Array, "m n"]) -> Float[Array, "m n"]:
        """Backlash: each joint stops short of where it is sent, on the side it comes from."""
        if self.world.backlash is None:
            return real
        result = real.copy()
        for k in range(1, len(real)):
            moved = np.sign(real[k] - real[k - 1])
            self._side = np.where(moved != 0, -moved, self._side)
            result[k] += 0.5 * self.world.backlash * self._side
        return result
