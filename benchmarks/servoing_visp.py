"""ViSP's published laws of visual servoing, written anew as reference for `servoing.py`.

``v = -lambda L^+ e`` with a constant gain, or the adaptive gain
``lambda(x) = (l0 - linf) exp(-l0' x / (l0 - linf)) + linf`` of x = max |e|, where l0 is the gain at zero
error, linf that far away and l0' the slope at zero; L is the interaction matrix of the current point, of
the desired one, or the mean of both (Marchand, Spindler, Chaumette 2005, IEEE RAM 12(4); the ViSP tutorial
on image-based servoing takes 0.5, and 4, 0.4, 30, at 25 pictures a second).
"""

from collections.abc import Callable

import numpy as np

from vision_robot.errors import NothingSeen
from vision_robot.geometry import WorkPlane
from vision_robot.pick.servo.interaction import ideal, plane_matrix
from vision_robot.pick.servo.kinematic import KinematicStage
from vision_robot.pick.servo.settings import Servoing
from vision_robot.pick.sighting import Sighting
from vision_robot.types import Array, Float

__all__ = ["GAINS", "JACOBIANS", "visp_law"]

SAMPLING_S = 0.04
MOST_LOOKS = 400

Gain = Callable[[float], float]


def adaptive(at_zero: float, far: float, slope: float) -> Gain:
    """The adaptive gain."""
    return lambda x: (at_zero - far) * float(np.exp(-slope * x / (at_zero - far))) + far


GAINS: dict[str, Gain] = {"constant": lambda _: 0.5, "adaptive": adaptive(4.0, 0.4, 30.0)}

JACOBIANS: dict[str, tuple[float, float]] = {
    "current": (1.0, 0.0),
    "desired": (0.0, 1.0),
    "mean": (0.5, 0.5),
}
"""Name -> weights of the interaction matrices of the current and of the desired point."""


def visp_law(
    gain: Gain, weights: tuple[float, float]
) -> Callable[[KinematicStage, Sighting, Servoing], None]:
    """A law that runs until it has used its looks up, at the lowest height."""

    def law(stage: KinematicStage, first: Sighting, how: Servoing) -> None:
        place, height = np.array(first.position_m), how.heights_m[-1]
        for _ in range(MOST_LOOKS):
            stage.go(Sighting(place, first.covariance_m2, first.yaw_rad, first.height_m), height)
            try:
                seen = stage.look()
            except NothingSeen:
                return
            wanted = stage.plane.pixels(first.position_m[None], z_m=float(seen.label_in_station[2]))
            now, goal = ideal(stage.plane, np.stack([seen.pixel, wanted[0]]))
            stage.note(float(np.linalg.norm(now - goal)))
            L = _mean(stage.plane, now, goal, seen.label_in_station, weights)
            velocity = -gain(float(np.abs(now - goal).max())) * np.linalg.solve(L, now - goal)
            place = place + SAMPLING_S * velocity

    return law


def _mean(
    plane: WorkPlane,
    now: Float[Array, "2"],
    goal: Float[Array, "2"],
    label_in_station: Float[Array, "3"],
    weights: tuple[float, float],
) -> Float[Array, "2 2"]:
    here, there = plane_matrix(plane, now, label_in_station), plane_matrix(plane, goal, label_in_station)
    return weights[0] * here + weights[1] * there
