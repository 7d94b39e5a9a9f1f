"""Horizontal rail, shoulder, elbow, wrist pitch, roll."""

from collections.abc import Sequence
from typing import Any

from vision_robot.arm.closed_form.screws import Screws
from vision_robot.arm.closed_form.structure import Structure
from vision_robot.arm.closed_form.subproblems import angle_between, constant, place_two_links, turned

__all__ = ["RailElbow"]


class RailElbow(Structure):
    """Slide u, turns 2, 3 and 4 about u, turn 5 about c at right angles to u."""

    name = "rail along the shoulder's axis, shoulder, elbow, wrist pitch, roll"
    pattern = "PRRRR"

    @staticmethod
    def conditions(screws: Screws) -> Sequence[tuple[str, float]]:
        """Axes 1 to 4 parallel, 5 at right angles to them."""
        a, b, c, d, e = screws.names
        return (
            (f"{b} turns about the direction of {a}", screws.parallel(0, 1)),
            (f"{c} turns about the direction of {a}", screws.parallel(0, 2)),
            (f"{d} turns about the direction of {a}", screws.parallel(0, 3)),
            (f"the axis of {e} is at right angles to that of {d}", screws.upright(3, 4)),
        )

    @staticmethod
    def branches(screws: Screws, turn: Any, shift: Any) -> list[list[Any]]:
        """Elbow either way."""
        import casadi as ca

        u, c = constant(screws.axes[0]), constant(screws.axes[4])
        p2, p3, p4, p5 = (constant(point) for point in screws.points[1:])
        end = ca.mtimes(turn, p5) + shift
        pitch = angle_between(u, c, ca.mtimes(turn, c))
        q5 = angle_between(c, u, turned(u, -pitch, ca.mtimes(turn, u)))
        q1 = ca.dot(u, end - p5)
        solutions = []
        for s, t in place_two_links(u, p3 - p2, p4 - p3, end - turned(u, pitch, p5 - p4) - p2):
            turns = (screws.sign(0, k) * angle for k, angle in ((1, s), (2, t), (3, pitch - s - t)))
            solutions.append([q1, *turns, q5])
        return solutions
