"""Frames that never arrive: the driver hands out the last one again."""

from vision_robot_synth.sensor.chance import Purpose, generator

__all__ = ["delivered"]


def delivered(frame: int, probability: float, seed: int) -> int:
    """The frame whose picture is handed out at `frame`: itself, or the last before it that arrived.

    The first always arrives.
    """
    if probability == 0:
        return frame
    while frame > 0 and generator(seed, Purpose.DROPS, frame).random() < probability:
        frame -= 1
    return frame
