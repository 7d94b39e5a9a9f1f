"""How many seeds would settle a comparison, and what those at hand could."""

from statistics import NormalDist

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["detectable", "seeds_needed"]


def seeds_needed(
    differences: Float[Array, "k"], *, smallest: float, power: float = 0.8, level: float = 0.05
) -> int | None:
    """Seeds at which a true difference of `smallest` would be found with probability `power`.

    From the spread of the paired differences seen so far (k seeds), by the normal approximation with
    Guenther's correction for Student's t: ``n = ((z_a + z_b) s / d)^2 + z_a^2 / 2``. None where fewer
    than two seeds or no difference to look for leave it open.
    """
    known = differences[np.isfinite(differences)]
    if len(known) < 2 or not smallest > 0:
        return None
    normal = NormalDist()
    z_level, z_power = normal.inv_cdf(1 - level / 2), normal.inv_cdf(power)
    spread = float(known.std(ddof=1))
    return max(2, int(np.ceil(((z_level + z_power) * spread / smallest) ** 2 + z_level**2 / 2)))


def detectable(differences: Float[Array, "k"], *, power: float = 0.8, level: float = 0.05) -> float | None:
    """The smallest true difference that these seeds would find with probability `power`.

    `seeds_needed` the other way round. None where they are too few for any.
    """
    known = differences[np.isfinite(differences)]
    normal = NormalDist()
    z_level, z_power = normal.inv_cdf(1 - level / 2), normal.inv_cdf(power)
    left = len(known) - z_level**2 / 2
    if len(known) < 2 or left <= 0:
        return None
    return float((z_level + z_power) * known.std(ddof=1) / np.sqrt(left))
