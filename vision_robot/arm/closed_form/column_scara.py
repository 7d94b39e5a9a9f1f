"""Column, two upright axes, wrist pitch, roll: the project's own arm."""

from collections.abc import Sequence
from typing import Any

from vision_robot.arm.closed_form.screws import Screws
from vision_robot.arm.closed_form.structure import Structure
from vision_robot.arm.closed_form.subproblems import angle_between, constant, place_two_links, project, turned

__all__ = ["ColumnScara"]


class ColumnScara(Structure):
    """Slide along u, 2 and 3 about u; turn 4 about b at right angles to u; 5 about c at right angles to b."""

    name = "column, two upright axes, wrist pitch, roll"
    pattern = "PRRRR"

    @staticmethod
    def conditions(screws: Screws) -> Sequence[tuple[str, float]]:
        """Axes 1, 2, 3 parallel; 4 at right angles to them and 5 to it."""
        a, b, c, d, e = screws.names
        return (
            (f"{b} turns about the direction of {a}", screws.parallel(0, 1)),
            (f"{c} turns about the direction of {a}", screws.parallel(0, 2)),
            (f"the axis of {d} is at right angles to that of {c}", screws.upright(2, 3)),
            (f"the axis of {e} is at right angles to that of {d}", screws.upright(3, 4)),
        )

    @staticmethod
    def branches(screws: Screws, turn: Any, shift: Any) -> list[list[Any]]:
        """Pitch either way, elbow either way."""
        import casadi as ca

        u, _, _, b, c = (constant(axis) for axis in screws.axes)
        p2, p3, p4, p5 = (constant(point) for point in screws.points[1:])
        # The roll axis is carried to `roll`; a point on it to `end`, whatever the roll.
        roll, end = ca.mtimes(turn, c), ca.mtimes(turn, p5) + shift
        level = project(u, roll)
        lean = ca.sqrt(ca.dot(level, level))
        # c is u turned about b by some angle; q4 adds to it, and leaves c leaning from u as `roll` does.
        lean_at_zero = angle_between(b, u, c)
        solutions = []
        for side in (1, -1):
            q4 = ca.atan2(side * lean, ca.dot(u, roll)) - lean_at_zero
            wrist = p4 + turned(b, q4, p5 - p4)
            for s, t in place_two_links(u, p3 - p2, wrist - p3, end - p2):
                facing = turned(b, -q4, turned(u, -(s + t), ca.mtimes(turn, b)))
                q5 = angle_between(c, b, facing)
                q1 = ca.dot(u, end - wrist)
                solutions.append([q1, screws.sign(0, 1) * s, screws.sign(0, 2) * t, q4, q5])
        return solutions
