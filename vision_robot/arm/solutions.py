"""What the solver answers: tables of joint values, one row a goal."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.types import Array, Bool, Float, Int

__all__ = ["Branches", "Solutions"]

SAME = 1e-5
"""Joint vectors nearer than this [m or rad] are one solution."""


@dataclass(frozen=True)
class Solutions:
    """Joint values for goals, measured where they really bring the tool."""

    joint_names: tuple[str, ...]
    q: Float[Array, "goals n"]
    """[m or rad]; where not converged, what comes closest."""
    position_error_m: Float[Array, "goals"]
    orientation_error_rad: Float[Array, "goals"]
    converged: Bool[Array, "goals"]
    """Within tolerance of the goal and inside all limits."""
    branch: Int[Array, "goals"]
    """Number of the closed form's branch; -1 where the numeric search gave the answer."""

    def __len__(self) -> int:
        return len(self.q)

    @classmethod
    def joined(cls, parts: Sequence["Solutions"]) -> "Solutions":
        """Several tables as one, in their order."""
        columns = ("q", "position_error_m", "orientation_error_rad", "converged", "branch")
        whole = {name: np.concatenate([getattr(part, name) for part in parts]) for name in columns}
        return cls(joint_names=parts[0].joint_names, **whole)


@dataclass(frozen=True)
class Branches:
    """All solutions found for goals: joint values, and which of them are right."""

    joint_names: tuple[str, ...]
    q: Float[Array, "goals branches n"]
    position_error_m: Float[Array, "goals branches"]
    orientation_error_rad: Float[Array, "goals branches"]
    right: Bool[Array, "goals branches"]
    """Reaches the goal inside the limits, and is no repetition of one before it."""

    @classmethod
    def of(
        cls,
        joint_names: tuple[str, ...],
        q: Float[Array, "goals branches n"],
        errors: Float[Array, "goals branches 2"],
        right: Bool[Array, "goals branches"],
        periods: Float[Array, "n"],
    ) -> "Branches":
        """From candidates; repetitions, whole `periods` left out, are marked as not right."""
        right = right.copy()
        safe = np.where(periods > 0, periods, np.inf)
        for goal in range(len(q)):
            kept: list[int] = []
            for b in np.flatnonzero(right[goal]):
                off = q[goal, kept] - q[goal, b]
                off = off - np.where(periods > 0, periods * np.round(off / safe), 0.0)
                if kept and (np.abs(off).max(axis=1) < SAME).any():
                    right[goal, b] = False
                else:
                    kept.append(int(b))
        return cls(joint_names, q, errors[..., 0], errors[..., 1], right)

    def of_goal(self, goal: int) -> Float[Array, "some n"]:
        """The solutions of one goal."""
        return self.q[goal, self.right[goal]]
