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


@pytest.mark.parametrize("angle_deg", [0, 3, 20, 45])
@pytest.mark.parametrize("sigma", [0.0, 0.1, 0.4])
def test_sharp_edges_are_averaged_over_square_pixels(angle_deg, sigma):
    """Against the mean of blurred steps over a fine grid of points of the pixel."""
    across = np.deg2rad(angle_deg)
    normal = np.array([[np.cos(across), np.sin(across)]])
    x = np.linspace(-1, 1, 41, dtype=np.float32)[None]
    points = (np.arange(200) + 0.5) / 200 - 0.5
    offset = (normal[0, 0] * points[:, None] + normal[0, 1] * points).ravel()
    gauss = np.random.default_rng(0).normal(size=offset.shape) * sigma
    exact = np.sign(x[0][:, None] + offset + gauss).mean(axis=1)
    sharpness = normal / np.sqrt(sigma**2 + 1 / 12)
    h = x * np.float32(np.linalg.norm(sharpness))
    S, Sh, _ = blurred_saddle(h, np.full_like(h, 8), (sharpness, SOFT), np.zeros(1))
    assert np.abs(S[0] - exact).max() < 0.04
    assert np.abs(np.gradient(S[0], h[0]) - Sh[0])[1:-1].max() < 0.12
