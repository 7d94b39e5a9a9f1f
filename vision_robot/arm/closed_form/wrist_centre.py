"""Waist, shoulder, elbow and three wrist axes through one point: most six-joint industrial arms."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from vision_robot.arm.closed_form.screws import Screws
from vision_robot.arm.closed_form.structure import Structure
from vision_robot.arm.closed_form.subproblems import (
    angle_between,
    constant,
    place_two_links,
    project,
    turned,
    turns_to_component,
)

__all__ = ["WristCentre"]


class WristCentre(Structure):
    """Turn 1 about u, 2 and 3 about b at right angles to u; 4, 5, 6 meet, 5 at right angles to 4 and 6."""

    name = "waist, shoulder, elbow and a wrist whose three axes meet"
    pattern = "RRRRRR"

    @staticmethod
    def conditions(screws: Screws) -> Sequence[tuple[str, float]]:
        """Axes 2 and 3 parallel and at right angles to 1; 4, 5 and 6 through one point."""
        a, b, c, d, e, f = screws.names
        centre, apart = screws.meeting(3, 4)
        along = screws.axes[5]
        to_last = centre - screws.points[5]
        return (
            (f"the axis of {b} is at right angles to that of {a}", screws.upright(0, 1)),
            (f"the axes of {b} and {c} are parallel", screws.parallel(1, 2)),
            (f"the axes of {d} and {e} are at right angles", screws.upright(3, 4)),
            (f"the axes of {e} and {f} are at right angles", screws.upright(4, 5)),
            (f"the axes of {d} and {e} meet", apart),
            (f"the axis of {f} passes where they meet", float(np.linalg.norm(np.cross(along, to_last)))),
        )

    @staticmethod
    def branches(screws: Screws, turn: Any, shift: Any) -> list[list[Any]]:
        """Waist either way round, elbow either way, wrist either way."""
        import casadi as ca

        u, b, _, d, e, f = (constant(axis) for axis in screws.axes)
        p1, p2, p3 = (constant(point) for point in screws.points[:3])
        centre = constant(screws.meeting(3, 4)[0])
        reach = ca.mtimes(turn, centre) + shift - p1
        solutions = []
        for waist in turns_to_component(
            ca.dot(b, reach), ca.dot(ca.cross(u, b), reach), ca.dot(b, centre - p1)
        ):
            end = turned(u, -waist, reach) + p1 - p2
            for s, t in place_two_links(b, p3 - p2, centre - p3, end):
                # What the wrist has left to turn, as it carries the last axis and the one before.
                last, middle = (
                    turned(b, -(s + t), turned(u, -waist, ca.mtimes(turn, vector))) for vector in (f, e)
                )
                level = project(d, last)
                lean, lean_at_zero = ca.sqrt(ca.dot(level, level)), angle_between(e, d, f)
                for side in (1, -1):
                    q5 = ca.atan2(side * lean, ca.dot(d, last)) - lean_at_zero
                    leaning = turned(e, q5, f)
                    q4 = angle_between(d, leaning, last)
                    q6 = angle_between(f, e, turned(e, -q5, turned(d, -q4, middle)))
                    solutions.append([waist, s, screws.sign(1, 2) * t, q4, q5, q6])
        return solutions
