"""Waist, three parallel axes and two more: the light six-joint arms of Universal Robots' kind."""

from collections.abc import Sequence
from typing import Any

from vision_robot.arm.closed_form.screws import Screws
from vision_robot.arm.closed_form.structure import Structure
from vision_robot.arm.closed_form.subproblems import (
    angle_between,
    constant,
    place_two_links,
    turned,
    turns_to_component,
)

__all__ = ["ThreeParallel"]


class ThreeParallel(Structure):
    """Turn 1 about u; 2, 3 and 4 about b at right angles to u; 5 at right angles to b and to 6, meeting 6."""

    name = "waist, three parallel axes, two wrist axes"
    pattern = "RRRRRR"

    @staticmethod
    def conditions(screws: Screws) -> Sequence[tuple[str, float]]:
        """Axes 2 to 4 parallel and at right angles to 1; 5 at right angles to 4 and 6 and meeting 6."""
        a, b, c, d, e, f = screws.names
        return (
            (f"the axis of {b} is at right angles to that of {a}", screws.upright(0, 1)),
            (f"the axes of {b} and {c} are parallel", screws.parallel(1, 2)),
            (f"the axes of {b} and {d} are parallel", screws.parallel(1, 3)),
            (f"the axes of {d} and {e} are at right angles", screws.upright(3, 4)),
            (f"the axes of {e} and {f} are at right angles", screws.upright(4, 5)),
            (f"the axes of {e} and {f} meet", screws.meeting(4, 5)[1]),
        )

    @staticmethod
    def branches(screws: Screws, turn: Any, shift: Any) -> list[list[Any]]:
        """Waist either way round, wrist either way, elbow either way."""
        import casadi as ca

        u, b, _, _, e, f = (constant(axis) for axis in screws.axes)
        p1, p2, p3, p4 = (constant(point) for point in screws.points[:4])
        tip = constant(screws.meeting(4, 5)[0])
        reach = ca.mtimes(turn, tip) + shift - p1
        solutions = []
        # No joint but the waist moves the meeting point of the last two axes along b.
        for waist in turns_to_component(ca.dot(b, reach), ca.dot(ca.cross(u, b), reach), ca.dot(b, tip - p1)):
            last, side_of_b = turned(u, -waist, ca.mtimes(turn, f)), ca.mtimes(turn.T, turned(u, waist, b))
            across = last - b * ca.dot(b, last)
            lean, lean_at_zero = ca.sqrt(ca.dot(across, across)), angle_between(e, b, f)
            for side in (1, -1):
                q5 = ca.atan2(side * lean, ca.dot(b, last)) - lean_at_zero
                q6 = angle_between(f, side_of_b, turned(e, -q5, b))
                pitch = angle_between(b, e, turned(u, -waist, ca.mtimes(turn, turned(f, -q6, e))))
                end = turned(u, -waist, reach) + p1 - turned(b, pitch, tip - p4) - p2
                for s, t in place_two_links(b, p3 - p2, p4 - p3, end):
                    turns = (screws.sign(1, k) * angle for k, angle in ((1, s), (2, t), (3, pitch - s - t)))
                    solutions.append([waist, *turns, q5, q6])
        return solutions
