"""Waiting for a label that is out of sight, but not for ever."""

from collections.abc import Sequence

import numpy as np

from vision_robot.errors import LostSight, NothingSeen
from vision_robot.pick.servo.settings import Servoing
from vision_robot.pick.servo.stage import Glimpse, Stage

__all__ = ["LABEL_ON_HAND", "still_looks"]

LABEL_ON_HAND = "the label on the hand"


def still_looks(stage: Stage, how: Servoing, count: int = 1) -> Sequence[Glimpse]:
    """`count` pictures of a hand that stands still, waiting `how.patience_s` for the first of them.

    Raises LostSight at once where lost sight means to abort.
    """
    since, seen = stage.time_s, []
    stage.wait(stage.latency_s)
    while len(seen) < count:
        try:
            seen.append(stage.look())
        except NothingSeen as error:
            gone = stage.time_s - since
            if how.lost == "abort" or gone >= how.patience_s:
                if seen:
                    break
                raise LostSight(LABEL_ON_HAND, gone, np.inf) from error
        if len(seen) < count:
            stage.wait(stage.period_s)
    return seen
