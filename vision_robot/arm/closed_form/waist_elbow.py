"""Waist, shoulder, elbow, wrist pitch, roll: most small arms of five servos."""

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

__all__ = ["WaistElbow"]


class WaistElbow(Structure):
    """Turn 1 about u, turns 2, 3 and 4 about b at right angles to u, turn 5 about c at right angles to b."""

    name = "waist, shoulder, elbow, wrist pitch, roll"
    pattern = "RRRRR"

    @staticmethod
    def conditions(screws: Screws) -> Sequence[tuple[str, float]]:
        """Axes 2 to 4 parallel and at right angles to 1, 5 at right angles to them."""
        a, b, c, d, e = screws.names
        return (
            (f"the axis of {b} is at right angles to that of {a}", screws.upright(0, 1)),
            (f"the axes of {b} and {c} are parallel", screws.parallel(1, 2)),
            (f"the axes of {b} and {d} are parallel", screws.parallel(1, 3)),
            (f"the axis of {e} is at right angles to that of {d}", screws.upright(3, 4)),
        )

    @staticmethod
    def branches(screws: Screws, turn: Any, shift: Any) -> list[list[Any]]:
        """Waist either way round, elbow either way."""
        import casadi as ca

        u, b, _, _, c = (constant(axis) for axis in screws.axes)
        p1, p2, p3, p4, p5 = (constant(point) for point in screws.points)
        reach = ca.mtimes(turn, p5) + shift - p1
        solutions = []
        for waist in turns_to_component(ca.dot(b, reach), ca.dot(ca.cross(u, b), reach), ca.dot(b, p5 - p1)):
            pitch = angle_between(b, c, turned(u, -waist, ca.mtimes(turn, c)))
            q5 = angle_between(c, b, turned(b, -pitch, turned(u, -waist, ca.mtimes(turn, b))))
            end = turned(u, -waist, reach) + p1 - turned(b, pitch, p5 - p4)
            for s, t in place_two_links(b, p3 - p2, p4 - p3, end - p2):
                turns = (screws.sign(1, k) * angle for k, angle in ((1, s), (2, t), (3, pitch - s - t)))
                solutions.append([waist, *turns, q5])
        return solutions
