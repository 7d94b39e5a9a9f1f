"""Stand, look, take the whole step, until what is known at the thing is known well enough."""

from collections.abc import Sequence

import numpy as np

from vision_robot.errors import LostSight
from vision_robot.pick.servo.camera_shift import camera_shift
from vision_robot.pick.servo.patience import LABEL_ON_HAND, still_looks
from vision_robot.pick.servo.settings import Servoing
from vision_robot.pick.servo.stage import Glimpse, Stage
from vision_robot.pick.sighting import Sighting

__all__ = ["known_by", "look_move_look"]

SURE = 2.0
"""Standard deviations within which a step is no longer known to be one."""


def look_move_look(stage: Stage, first: Sighting, how: Servoing) -> Sighting:
    """The thing's place, as it has to be told to the arm, and its covariance.

    The label is seen higher up than the thing, and a camera that was knocked errs differently there. So it
    is looked at from both heights, and what all looks together say about the camera is one least-squares fit,
    through whose camera the thing is met again: a Newton step, its Jacobian mended by every look. It ends
    when that fit knows the thing to `how.stop_m` and the last step was no more than the fit's noise.
    """
    glimpses: list[Glimpse] = []
    place, sigma = first, np.inf
    for k in range(how.most_looks):
        stage.go(place, how.heights_m[k % len(how.heights_m)])
        try:
            glimpses += still_looks(stage, how)
        except LostSight as lost:
            if how.lost != "predict" or sigma > how.enough_m:
                raise LostSight(LABEL_ON_HAND, lost.seconds, sigma) from lost
            return place
        again, sigma = known_by(stage, first, how, glimpses)
        step = float(np.linalg.norm(again.position_m - place.position_m))
        stage.note(step, sigma)
        place = again
        if k + 1 >= len(how.heights_m) and sigma <= how.stop_m and step <= SURE * sigma:
            break
    if sigma > how.enough_m:
        raise LostSight(LABEL_ON_HAND, 0.0, sigma)
    return place


def known_by(
    stage: Stage, first: Sighting, how: Servoing, glimpses: Sequence[Glimpse]
) -> tuple[Sighting, float]:
    """The thing's place by what all looks say of the camera, and the sigma [m] that they leave."""
    shift = camera_shift(stage.plane, glimpses, how.turn_sigma_rad, how.shift_sigma_m)
    return shift.met_again(first)
