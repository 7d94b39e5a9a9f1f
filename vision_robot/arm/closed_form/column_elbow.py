"""Column, waist, shoulder, elbow, roll."""

from collections.abc import Sequence
from typing import Any

from vision_robot.arm.closed_form.screws import Screws
from vision_robot.arm.closed_form.structure import Structure
from vision_robot.arm.closed_form.subproblems import angle_between, constant, turned, turns_to_component

__all__ = ["ColumnElbow"]


class ColumnElbow(Structure):
    """Slide along u, turn 2 about u; 3 and 4 about b at right angles to u; 5 about c at right angles to b."""

    name = "column, waist, shoulder, elbow, roll"
    pattern = "PRRRR"

    @staticmethod
    def conditions(screws: Screws) -> Sequence[tuple[str, float]]:
        """Axes 1 and 2 parallel, 3 and 4 parallel and at right angles to them, 5 at right angles to 4."""
        a, b, c, d, e = screws.names
        return (
            (f"{b} turns about the direction of {a}", screws.parallel(0, 1)),
            (f"the axis of {c} is at right angles to that of {b}", screws.upright(1, 2)),
            (f"the axes of {c} and {d} are parallel", screws.parallel(2, 3)),
            (f"the axis of {e} is at right angles to that of {d}", screws.upright(3, 4)),
        )

    @staticmethod
    def branches(screws: Screws, turn: Any, shift: Any) -> list[list[Any]]:
        """Waist either way round, shoulder either way."""
        import casadi as ca

        u, _, b, _, c = (constant(axis) for axis in screws.axes)
        p2, p3, p4, p5 = (constant(point) for point in screws.points[1:])
        ahead = ca.cross(b, u)
        roll, end = ca.mtimes(turn, c), ca.mtimes(turn, p5) + shift
        solutions = []
        # Shoulder and elbow move the end along no b: the waist alone has to bring it there.
        reach = end - p2
        for waist in turns_to_component(ca.dot(b, reach), ca.dot(ca.cross(u, b), reach), ca.dot(b, p5 - p2)):
            pitch = angle_between(b, c, turned(u, -waist, roll))
            elbow = turned(u, -waist, reach) + p2 - p3 - turned(b, pitch, p5 - p4)
            link = p4 - p3
            for q3 in turns_to_component(
                ca.dot(ahead, link), ca.dot(ahead, ca.cross(b, link)), ca.dot(ahead, elbow)
            ):
                facing = turned(b, -pitch, turned(u, -waist, ca.mtimes(turn, b)))
                q1 = ca.dot(u, elbow - turned(b, q3, link))
                q4 = screws.sign(2, 3) * (pitch - q3)
                solutions.append([q1, screws.sign(0, 1) * waist, q3, q4, angle_between(c, b, facing)])
        return solutions
