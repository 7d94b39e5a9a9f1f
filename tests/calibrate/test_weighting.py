"""Trust in the detector: scale and floor are found back from residuals that have them."""

import numpy as np
import pytest

from vision_robot.calibrate.weighting import trust


def lengths(sigma: np.ndarray, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.hypot(*(rng.normal(size=(2, len(sigma))) * sigma))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("scale", "floor"), [(1.0, 0.0), (2.0, 0.0), (1.0, 0.05), (1.5, 0.3)])
def test_scale_and_floor_come_back(seed, scale, floor):
    sigma = np.random.default_rng(seed + 100).uniform(0.01, 0.2, 4000)
    found = trust(lengths(np.hypot(scale * sigma, floor), seed), sigma)
    total = found.sigma(sigma)
    np.testing.assert_allclose(total, np.hypot(scale * sigma, floor), rtol=0.1, atol=0.004)


def test_a_few_outliers_do_not_raise_the_floor():
    sigma = np.random.default_rng(1).uniform(0.01, 0.2, 4000)
    seen = lengths(sigma, 2)
    seen[::100] += 20.0
    assert trust(seen, sigma).floor_px < 0.05


def test_equal_sigmas_only_tell_the_scale():
    found = trust(lengths(np.full(4000, 0.3), 3), np.full(4000, 0.1))
    assert found.scale == pytest.approx(3.0, rel=0.05)
    assert found.floor_px == 0


def test_corners_nearly_alike_count_alike():
    """A floor that drowns the detector's sigmas leaves plain least squares."""
    sigma = np.random.default_rng(4).uniform(0.01, 0.05, 4000)
    found = trust(lengths(np.hypot(sigma, 0.2), 5), sigma)
    assert found.scale == 0
    assert found.floor_px == pytest.approx(0.2, rel=0.05)
