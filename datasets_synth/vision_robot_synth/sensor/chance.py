"""Chance that depends on seed, purpose and frame alone, never on the order in which frames are made."""

from enum import IntEnum

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["Purpose", "drift", "generator"]

WAVES = 5


class Purpose(IntEnum):
    """What a number is drawn for; each has a stream of its own, so that one effect never shifts another."""

    NOISE = 1
    DROPS = 2
    EXPOSURE = 3
    RED = 4
    BLUE = 5
    FLICKER = 6
    SHADE = 7
    SHAKE = 8
    SCENE = 9
    VALUES = 10


def generator(seed: int, purpose: Purpose, index: int = 0) -> np.random.Generator:
    """A generator for one purpose and one frame (or object)."""
    return np.random.Generator(np.random.SFC64([seed, int(purpose), index]))


def drift(time_s: Float[Array, "*n"] | float, period_s: float, seed: int, purpose: Purpose, index: int = 0):
    """A smooth wandering around 0 with standard deviation 1, a function of time alone.

    A sum of sines with periods from one to four times `period_s`, which is therefore the fastest.
    """
    rng = generator(seed, purpose, index)
    phases = rng.uniform(0, 2 * np.pi, WAVES)
    periods = period_s * 4 ** ((np.arange(WAVES) + rng.uniform(0, 1, WAVES)) / WAVES)
    angle = 2 * np.pi * np.asarray(time_s, dtype=float)[..., None] / periods + phases
    return np.sin(angle).sum(axis=-1) * np.sqrt(2 / WAVES)
