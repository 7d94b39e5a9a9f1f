"""Homographies: exact on exact points, optimal in the picture under noise."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vision_robot.calibrate.homography import apply_homography, fit_homographies


def random_homographies(seed: int, count: int = 5) -> np.ndarray:
    rng = np.random.default_rng(seed)
    H = np.eye(3) + rng.normal(size=(count, 3, 3)) * [[0.3, 0.3, 2], [0.3, 0.3, 2], [0.05, 0.05, 0]]
    return np.diag([500.0, 500.0, 1.0]) @ H


def grid(count: int) -> np.ndarray:
    x, y = np.meshgrid(np.linspace(-1, 1, 6), np.linspace(-1, 1, 5))
    return np.broadcast_to(np.stack([x, y], axis=-1).reshape(-1, 2), (count, 30, 2))


@given(st.integers(0, 10_000))
@settings(max_examples=25)
def test_exact_points_give_back_the_homography(seed):
    H = random_homographies(seed)
    plane = grid(len(H))
    fitted = fit_homographies(plane, apply_homography(H, plane), np.ones(plane.shape[:2]))
    np.testing.assert_allclose(apply_homography(fitted, plane), apply_homography(H, plane), atol=1e-7)


def test_missing_points_have_no_say():
    H = random_homographies(1)
    plane, weight = grid(len(H)), np.ones((len(H), 30))
    pixels = apply_homography(H, plane)
    pixels[:, 7], weight[:, 7] = 1e4, 0
    fitted = fit_homographies(plane, pixels, weight)
    keep = weight[0] > 0
    np.testing.assert_allclose(apply_homography(fitted, plane)[:, keep], pixels[:, keep], atol=1e-7)


def test_the_fit_is_a_minimum_of_the_distance_in_the_picture():
    rng = np.random.default_rng(2)
    H = random_homographies(2)
    plane = grid(len(H))
    pixels = apply_homography(H, plane) + rng.normal(size=plane.shape)
    fitted = fit_homographies(plane, pixels, np.ones(plane.shape[:2]))

    def cost(G):
        return ((apply_homography(G, plane) - pixels) ** 2).sum(axis=(1, 2))

    best = cost(fitted)
    for _ in range(50):
        nudged = fitted * (1 + 1e-4 * rng.normal(size=fitted.shape))
        assert (cost(nudged) >= best * (1 - 1e-9)).all()


def test_the_horizon_is_not_finite():
    H = np.array([[[1.0, 0, 0], [0, 1, 0], [1, 0, 1]]])
    assert not np.isfinite(apply_homography(H, np.array([[[-1.0, 0.0]]]))).any()


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_the_unit_of_the_plane_does_not_matter(scale):
    H = random_homographies(3)
    plane = grid(len(H))
    pixels = apply_homography(H, plane)
    fitted = fit_homographies(plane * scale, pixels, np.ones(plane.shape[:2]))
    np.testing.assert_allclose(apply_homography(fitted, plane * scale), pixels, atol=1e-7)
