"""Why a goal is out of reach: what comes closest, how far that is, and what forbids the rest."""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.arm.ik import InverseKinematics
from vision_robot.arm.solutions import Solutions
from vision_robot.arm.task import Task
from vision_robot.geometry import SE3
from vision_robot.types import Array, Bool, Float

__all__ = ["Obstacle", "Reason", "Unreachable"]


@dataclass(frozen=True)
class Obstacle:
    """A joint that would have to pass its limit."""

    joint: str
    limit: float
    needed: float
    """[m or rad], both."""
    slides: bool

    @property
    def words(self) -> str:
        """As a person would say it."""
        scale, unit = (1000, "mm") if self.slides else (180 / np.pi, "deg")
        needed, limit = scale * self.needed, scale * self.limit
        return f"{self.joint} would have to be {needed:.1f} {unit}, its limit is {limit:.1f}"


@dataclass(frozen=True)
class Reason:
    """Why one goal is not reached."""

    kind: str
    """limit, length or orientation."""
    obstacles: tuple[Obstacle, ...]
    position_error_m: float
    orientation_error_rad: float
    """Of the joint values that come closest, distances and angles weighed by the arm's length scale."""
    text: str


class Unreachable:
    """Finds reasons for the goals that a solver does not reach."""

    def __init__(self, ik: InverseKinematics):
        self.ik = ik
        self._solvers: dict[tuple[Task, bool], InverseKinematics] = {}

    def reason(self, base_from_tool: SE3, solutions: Solutions, goal: int) -> Reason:
        """Why `goal`, not converged in `solutions`, is not reached."""
        wanted = base_from_tool[goal : goal + 1]
        distance = float(solutions.position_error_m[goal])
        angle = float(solutions.orientation_error_rad[goal])
        short = f"closest: {1000 * distance:.1f} mm and {np.degrees(angle):.2f} deg off"
        kind, obstacles, why = self._why(wanted)
        return Reason(kind, obstacles, distance, angle, f"{why}; {short}")

    def _why(self, goal: SE3) -> tuple[str, tuple[Obstacle, ...], str]:
        """Kind, obstacles and words: the whole task is asked first, then less and less of it."""
        for task in Task:
            if not _asks_no_more(task, self.ik.task):
                continue
            if task is not self.ik.task and self._solver(task, free=False).solve(goal).converged[0]:
                return "orientation", (), self._orientation(goal, task)
            obstacles = self._obstacles(self._solver(task, free=True), goal)
            if obstacles is not None:
                words = "; ".join(one.words for one in obstacles) or "only just: rounding decides"
                return "limit", obstacles, words + (WITHOUT[task] if task is not self.ik.task else "")
            if task is Task.TILT:
                return "length", (), self._length(goal, task)
        return "length", (), self._length(goal, Task.POSITION)

    def _obstacles(self, free: InverseKinematics, goal: SE3) -> tuple[Obstacle, ...] | None:
        """Joints that must pass limits, in the branch that passes them least; None without a branch."""
        found = free.branches(goal).of_goal(0)
        if not len(found):
            return None
        chain = self.ik.arm.chain
        inside = np.clip(found, *chain.limits.T)
        over = np.abs(found - inside) / np.where(chain.slides, self.ik.program.scale, 1.0)
        least = int(np.lexsort([over.sum(axis=1), (over > 1e-9).sum(axis=1)])[0])
        return tuple(
            Obstacle(name, float(inside[least, i]), float(found[least, i]), bool(chain.slides[i]))
            for i, name in enumerate(chain.joint_names)
            if over[least, i] > 1e-9
        )

    def _orientation(self, goal: SE3, task: Task) -> str:
        """Words for a goal of which less, `task`, can be reached."""
        count = len(self.ik.arm)
        text = "the position can be reached, but not with this orientation"
        if task is not Task.TILT:
            return text
        found = self._solver(Task.TILT, free=False).solve(goal)
        reached = self.ik.arm.chain.base_from_tool(found.q[0]).rotation
        heading, asked = (
            np.degrees(np.arctan2(turn[1, 0], turn[0, 0])) for turn in (reached, goal.rotation[0])
        )
        return (
            f"{text}: {count} joints cannot meet all six numbers of a pose; with this tilt the tool's x axis "
            f"points to {heading:.1f} deg here, not to {asked:.1f} (task tilt leaves that to the arm)"
        )

    def _length(self, goal: SE3, task: Task) -> str:
        """Words for a goal that no joint values reach, limits or not: how far out or in the tool comes."""
        chain = self.ik.arm.chain
        hinges = np.flatnonzero(~chain.slides)
        if not len(hinges):
            return "the joints slide past it"
        first = int(hinges[0])
        frame = chain.base_from_joints(np.zeros(len(chain)))[first]
        axis = frame.rotation @ chain.axes[first]
        out = goal.translation[0] - frame.translation
        out = out - axis * (axis @ out)
        away = float(np.linalg.norm(out))
        out = out / away if away > 1e-9 else np.roll(axis, 1)
        name = chain.joint_names[first]
        here = f"from the axis of {name}, the goal is at {1000 * away:.0f} mm"
        tilted = " with this tilt" if task is Task.TILT else ""
        border = self._border(self._solver(task, free=True), goal, out, away)
        if border is None:
            return f"no place at this height can be reached{tilted}; measured {here}"
        what, verb = ("are too short", "reaches") if border < away else ("cannot fold that close", "comes to")
        short = f"the links {what}{tilted} by {1000 * abs(border - away):.1f} mm"
        return f"{short}: the tool {verb} {1000 * border:.0f} mm {here}"

    def _border(
        self, solver: InverseKinematics, goal: SE3, out: Float[Array, "3"], away: float
    ) -> float | None:
        """Distance nearest to `away` at which the goal, moved along `out`, is reached; None if nowhere."""

        def reached(radii: Float[Array, "some"]) -> Bool[Array, "some"]:
            places = goal.translation + (radii - away)[:, None] * out
            turns = np.broadcast_to(goal.rotation, (len(radii), 3, 3))
            return solver.sketch(SE3(turns, places))[1]

        radii = np.linspace(0, 1.5 * self.ik.arm.reach_m, 31)
        good = radii[reached(radii)]
        if not len(good):
            return None
        inside = float(good[np.argmin(np.abs(good - away))])
        outside = away
        for _ in range(14):
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if reached(np.array([middle]))[0] else (inside, middle)
        return inside

    def _solver(self, task: Task, *, free: bool) -> InverseKinematics:
        """A solver of the same arm for another task, without limits where `free`."""
        if (task, free) in self._solvers:
            return self._solvers[task, free]
        arm = self.ik.arm
        if free:
            chain = arm.chain
            middle = chain.limits.mean(axis=1)
            half = np.where(chain.slides, np.diff(chain.limits, axis=1)[:, 0] + 10 * arm.reach_m, np.pi)
            limits = np.stack([middle - half, middle + half], axis=1)
            arm = replace(arm, chain=replace(chain, limits=limits))
        # In numpy: compiling once more would cost more than the few goals it is asked.
        made = InverseKinematics(
            arm, task, method=self.ik.method, compiled=False, tolerance=self.ik.tolerance
        )
        return self._solvers.setdefault((task, free), made)


WITHOUT = {
    Task.AXIS: " (were only its axis asked for)",
    Task.TILT: " (were only its tilt asked for)",
    Task.POSITION: " (were only its position asked for)",
}


def _asks_no_more(task: Task, than: Task) -> bool:
    """Whether `task` is `than` itself or part of it."""
    parts = {
        Task.POSE: (Task.POSE, Task.TILT, Task.POSITION),
        Task.AXIS: (Task.AXIS, Task.POSITION),
        Task.TILT: (Task.TILT, Task.POSITION),
        Task.POSITION: (Task.POSITION,),
    }
    return task in parts[than]
