"""The closed form of a blurred corner is the blurred corner."""

import numpy as np
import pytest

from vision_robot.calibrate.saddle.model import blurred_saddle

SOFT = np.array([[0.1, 0.0]])


@pytest.mark.parametrize("correlation", [-0.8, -0.3, 0.0, 0.5, 0.9])
def test_values_are_those_of_the_blurred_signs(correlation):
    """Against the mean of sign(h + e1) sign(k + e2) over a fine grid of the two normal errors."""
    e = np.linspace(-6, 6, 1201)
    density = np.exp(-(e**2) / 2)
    density /= density.sum()
    root = np.sqrt(1 - correlation**2)
    for h, k in [(0.0, 0.0), (0.5, -0.3), (1.5, 0.2), (-0.7, 1.1), (2.5, 2.0)]:
        second = correlation * e[:, None] + root * e[None, :]
        exact = (np.sign(h + e)[:, None] * np.sign(k + second) * density[:, None] * density).sum()
        S, _, _ = blurred_saddle(
            np.array([[h]], np.float32), np.array([[k]], np.float32), (SOFT, SOFT), np.array([correlation])
        )
        assert S[0, 0] == pytest.approx(exact, abs=0.012)


def test_derivatives_are_those_of_the_values():
    """Central differences, near and far from the corner, pixel's shape included."""
    rng = np.random.default_rng(0)
    h, k = rng.uniform(-2.5, 2.5, (2, 3, 40)).astype(np.float32)
    sharp = np.array([[0.5, 0.2], [2.5, 1.0], [1.0, -3.0]])
    correlation = np.array([-0.6, 0.1, 0.7])

    def value(h, k):
        return blurred_saddle(h, k, (sharp, sharp[::-1]), correlation)[0]

    step = np.float32(1e-2)
    _, Sh, Sk = blurred_saddle(h, k, (sharp, sharp[::-1]), correlation)
    near = h * h + k * k - 2 * np.abs(correlation[:, None] * h * k) < 8 * (1 - correlation[:, None] ** 2)
    assert np.abs(Sh - (value(h + step, k) - value(h - step, k)) / (2 * step))[near].max() < 2e-3
    assert np.abs(Sk - (value(h, k + step) - value(h, k - step)) / (2 * step))[near].max() < 2e-3


def test_even_under_reflection_in_the_corner():
    """The symmetry that keeps errors of the model from moving the corner."""
    h, k = np.random.default_rng(1).uniform(-3, 3, (2, 2, 50)).astype(np.float32)
    correlation = np.array([0.4, -0.5])
    sharp = np.array([[2.0, 1.0], [0.3, 3.0]])
    S = blurred_saddle(h, k, (sharp, sharp), correlation)[0]
    assert np.array_equal(S, blurred_saddle(-h, -k, (sharp, sharp), correlation)[0])


def test_sharp_pixel_wide_edge_is_flattened_towards_the_box():
    """With no blur but the pixel's own, the edge profile is closer to a ramp than the error function is."""
    x = np.linspace(-0.45, 0.45, 19, dtype=np.float32)[None]
    far = np.full_like(x, 8)
    straight = np.array([[np.sqrt(12), 0.0]])
    with_shape = blurred_saddle(x * np.float32(np.sqrt(12)), far, (straight, SOFT), np.zeros(1))[0]
    without = blurred_saddle(x * np.float32(np.sqrt(12)), far, (SOFT, SOFT), np.zeros(1))[0]
    assert np.abs(with_shape - 2 * x).max() < 0.7 * np.abs(without - 2 * x).max()
