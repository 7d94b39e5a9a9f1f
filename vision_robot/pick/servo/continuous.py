"""Laws that answer every picture while the hand moves: position-based and image-based."""

from collections import deque
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from vision_robot.errors import LostSight, NothingSeen, ServoAstray
from vision_robot.geometry import WorkPlane
from vision_robot.pick.servo.camera_shift import EXACT_PX
from vision_robot.pick.servo.interaction import image_step
from vision_robot.pick.servo.look_move_look import SURE, known_by
from vision_robot.pick.servo.patience import LABEL_ON_HAND, still_looks
from vision_robot.pick.servo.settings import Servoing
from vision_robot.pick.servo.stage import Glimpse, Stage
from vision_robot.pick.sighting import Sighting
from vision_robot.types import Array, Float

__all__ = ["image_based", "position_based"]

STILL_LOOKS = 2
"""Pictures of the hand at rest that are kept of each height."""

Law = Callable[[Stage, Glimpse, Float[Array, "2"]], Float[Array, "2"]]
"""(stage, what was seen, wanted place of the label [m]) -> step in the plane of {S} [m]."""


def position_based(stage: Stage, first: Sighting, how: Servoing) -> Sighting:
    """The error is taken in {S}: where the camera sees the label, against where it saw the thing."""

    def law(stage: Stage, seen: Glimpse, wanted_m: Float[Array, "2"]) -> Float[Array, "2"]:
        places, _ = stage.plane.measure(seen.pixel[None], z_m=float(seen.label_in_station[2]))
        return wanted_m - places[0]

    return _at_all_heights(stage, first, how, law, "position")


def image_based(stage: Stage, first: Sighting, how: Servoing) -> Sighting:
    """The error is taken in the picture: from the label's pixel to where it has to be."""

    def law(stage: Stage, seen: Glimpse, wanted_m: Float[Array, "2"]) -> Float[Array, "2"]:
        pixel = stage.plane.pixels(wanted_m[None], z_m=float(seen.label_in_station[2]))[0]
        return image_step(stage.plane, seen.label_in_station, seen.pixel, pixel)

    return _at_all_heights(stage, first, how, law, "image")


def _at_all_heights(stage: Stage, first: Sighting, how: Servoing, law: Law, name: str) -> Sighting:
    """Servo at one height after the other; the looks of all together tell the place at the thing."""
    glimpses: list[Glimpse] = []
    place = first
    for height in how.heights_m:
        stage.go(place, height)
        place = _settled(stage, place, first.position_m, height, how, law, name)
        stage.go(place, height)
        glimpses += still_looks(stage, how, STILL_LOOKS)
    place, sigma = known_by(stage, first, how, glimpses)
    if sigma > how.enough_m:
        raise LostSight(LABEL_ON_HAND, 0.0, sigma)
    return place


def _settled(
    stage: Stage,
    place: Sighting,
    wanted_m: Float[Array, "2"],
    height_m: float,
    how: Servoing,
    law: Law,
    name: str,
) -> Sighting:
    """Frames at the camera's rate, answered late, until the error stays within noise."""
    waiting: deque[tuple[Glimpse, Array]] = deque()
    begun = seen_s = stage.time_s
    error, commanded = np.zeros(2), place.position_m
    still = 0
    while still < how.still_frames:
        if stage.time_s - begun > how.most_seconds:
            raise ServoAstray(name, how.most_seconds, float(np.linalg.norm(error)))
        try:
            waiting.append((stage.look(), place.position_m))
        except NothingSeen as hidden:
            if how.lost == "abort" or stage.time_s - seen_s > how.patience_s + stage.latency_s:
                raise LostSight(LABEL_ON_HAND, stage.time_s - seen_s, np.inf) from hidden
        answered = False
        while waiting and waiting[0][0].time_s <= stage.time_s - stage.latency_s + 1e-9:
            seen, commanded = waiting.popleft()
            error, seen_s, answered = law(stage, seen, wanted_m), seen.time_s, True
            size = float(np.linalg.norm(error))
            stage.note(size)
            still = still + 1 if size < SURE * _noise_m(stage, seen) else 0
        goes_on = answered or (how.lost == "predict" and seen_s > begun)
        if goes_on:
            # What was commanded since the picture is on its way already.
            gone = place.position_m - commanded if how.compensate or not answered else np.zeros(2)
            share = min(1.0, how.gain_per_s * stage.period_s)
            place = replace(place, position_m=place.position_m + share * (error - gone))
        stage.step(place, height_m)
    return place


def _noise_m(stage: Stage, seen: Glimpse) -> float:
    """What the noise of the label's pixel is worth in {S} [m], in the worst direction."""
    exact = WorkPlane.exact(stage.plane.camera, stage.plane.cam_from_station)
    sigma = max(seen.sigma_px, EXACT_PX)
    _, covariance = exact.measure(seen.pixel[None], sigma, z_m=float(seen.label_in_station[2]))
    return float(np.sqrt(np.linalg.eigvalsh(covariance[0])[-1]))
