"""Proves that the derivatives are exact for the pictures they are made for."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.flow import cube, four_point, prefiltered


def picture(function, t, shape=(30, 40)):
    v, u = np.mgrid[: shape[0], : shape[1]].astype(float)
    return function(u, v, t)


def test_the_cube_is_exact_for_what_is_linear():
    def f(u, v, t):
        return 3 * u - 2 * v + 5 * t

    x, y, t = cube(picture(f, 0), picture(f, 1))
    inner = np.s_[:-1, :-1]
    np.testing.assert_allclose(x[inner], 3)
    np.testing.assert_allclose(y[inner], -2)
    np.testing.assert_allclose(t[inner], 5)


def test_the_cube_looks_from_the_middle_of_four_pixels():
    def f(u, v, t):
        return u * u + 0 * v * t

    x, _, _ = cube(picture(f, 0), picture(f, 1))
    u = np.arange(39)
    np.testing.assert_allclose(x[3, :-1], 2 * (u + 0.5))


def test_four_points_are_exact_for_cubics():
    def f(u, v, t):
        return (u / 10) ** 3 - (v / 10) ** 2 * (u / 10) + 4 * t

    x, y, t = four_point(picture(f, 0), picture(f, 1))
    v, u = np.mgrid[:30, :40] / 10
    inner = np.s_[2:-2, 2:-2]
    np.testing.assert_allclose(x[inner], (0.3 * u**2 - 0.1 * v**2)[inner], atol=1e-6)
    np.testing.assert_allclose(y[inner], (-0.2 * u * v)[inner], atol=1e-6)
    np.testing.assert_allclose(t, 4, atol=1e-9)


def test_the_prefilter_keeps_what_is_linear_and_takes_off_noise():
    def f(u, v, t):
        return 3 * u - 2 * v + 5 * t

    x, y, t = prefiltered([picture(f, k) for k in range(-3, 4)])
    inner = np.s_[8:-8, 8:-8]
    for found, expected in ((x, 3), (y, -2), (t, 5)):
        np.testing.assert_allclose(found[inner], expected, atol=1e-6)
    rng = np.random.default_rng(0)
    noise = [rng.normal(size=(60, 60)) for _ in range(5)]
    assert prefiltered(noise).x.std() < 0.2 * four_point(noise[2], noise[3]).x.std()


@pytest.mark.parametrize("count", [1, 4, 6])
def test_the_prefilter_wants_an_odd_number_of_frames(count):
    with pytest.raises(BadParameter, match="odd"):
        prefiltered([np.zeros((9, 9))] * count)
