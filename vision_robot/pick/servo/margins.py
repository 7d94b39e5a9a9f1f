"""How much gain and latency a continuous law bears before it swings up: eigenvalues of the sampled loop."""

import numpy as np

from vision_robot.geometry import WorkPlane
from vision_robot.pick.servo.interaction import ideal, plane_matrix
from vision_robot.types import Array, Float

__all__ = ["critical_gain_per_s", "critical_latency_s", "growth", "mismatch"]

MOST_FRAMES = 30


def growth(
    gain: float, delay: int, mismatch: complex = 1.0, *, compensate: bool = True, follow: float = 1.0
) -> float:
    """By how much the error grows from picture to picture in the long run; below 1 the loop is stable.

    `gain` is the share of the error that is commanded at each picture, `delay` the pictures until one is
    answered, `mismatch` an eigenvalue of (believed Jacobian)^-1 (true Jacobian), `follow` the share of its
    way that the hand goes in one period. The state is what was commanded and where the hand was, as far
    back as answers reach:

        c' = c - gain (mismatch r_delay + [compensate] (c - c_delay)),    r' = r + follow (c' - r)
    """
    n = delay + 1
    A = np.zeros((2 * n, 2 * n), dtype=complex)
    A[0, 0] = 1.0
    A[0, n + delay] -= gain * mismatch
    if compensate:
        A[0, 0] -= gain
        A[0, delay] += gain
    A[n] = follow * A[0]
    A[n, n] += 1 - follow
    for k in range(1, n):
        A[k, k - 1] = A[n + k, n + k - 1] = 1.0
    return float(np.abs(np.linalg.eigvals(A)).max())


def critical_gain_per_s(
    latency_s: float,
    period_s: float,
    mismatch: complex = 1.0,
    *,
    compensate: bool = True,
    lag_s: float = 0.0,
) -> float:
    """The least gain [1/s] at which the loop no longer calms down; infinite where a whole step still does.

    A law takes at most the whole step in a picture, a gain of one over the period.
    """
    delay, follow = _frames(latency_s, period_s), _follow(lag_s, period_s)

    def calm(gain: float) -> bool:
        return growth(gain, delay, mismatch, compensate=compensate, follow=follow) < 1

    gains = np.linspace(1e-3, 1.0, 80)
    wild = np.flatnonzero([not calm(float(gain)) for gain in gains])
    if not len(wild):
        return np.inf
    if wild[0] == 0:
        return 0.0
    low, high = float(gains[wild[0] - 1]), float(gains[wild[0]])
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (middle, high) if calm(middle) else (low, middle)
    return low / period_s


def critical_latency_s(
    gain_per_s: float,
    period_s: float,
    mismatch: complex = 1.0,
    *,
    compensate: bool = True,
    lag_s: float = 0.0,
) -> float:
    """The least latency [s], in whole pictures, at which the loop no longer calms down; infinite past 30."""
    gain, follow = min(1.0, gain_per_s * period_s), _follow(lag_s, period_s)
    for delay in range(MOST_FRAMES + 1):
        if growth(gain, delay, mismatch, compensate=compensate, follow=follow) >= 1:
            return delay * period_s
    return np.inf


def mismatch(believed: WorkPlane, true: WorkPlane, point_in_station: Float[Array, "3"]) -> complex:
    """Eigenvalue farthest from 1 of (believed Jacobian)^-1 (true Jacobian) for a point over the table."""
    pixel = true.pixels(point_in_station[None, :2], z_m=float(point_in_station[2]))
    seen = ideal(believed, pixel)[0]
    assumed, real = (
        plane_matrix(believed, seen, point_in_station),
        _true_matrix(believed, true, point_in_station),
    )
    values = np.linalg.eigvals(np.linalg.solve(assumed, real))
    return complex(values[int(np.argmax(np.abs(values - 1)))])


def _true_matrix(believed: WorkPlane, true: WorkPlane, point: Float[Array, "3"]) -> Float[Array, "2 2"]:
    """How the image, read by the believed lens, really moves with the point: central differences."""
    step = 1e-6
    ends = point[:2] + step * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])
    images = ideal(believed, true.pixels(ends, z_m=float(point[2])))
    return np.stack([images[0] - images[1], images[2] - images[3]], axis=1) / (2 * step)


def _frames(latency_s: float, period_s: float) -> int:
    return int(np.ceil(latency_s / period_s - 1e-9))


def _follow(lag_s: float, period_s: float) -> float:
    return float(1 - np.exp(-period_s / lag_s)) if lag_s > 0 else 1.0
