"""A path's rate is the derivative of its place, whatever the path."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.sim.paths import Circle, Straight, Sum, Sway, Waypoints

PATHS = {
    "straight": Straight((0.1, -0.2, 0.0, 0.3), (0.05, 0.1, 0.01, -0.4)),
    "waypoints": Waypoints((0.5, 1.0, 2.0), ((0, 0, 0, 0), (0.1, 0, 0, 1), (0.1, 0.2, 0, 1))),
    "circle": Circle((0.1, 0.2), 0.05, 1.3, 0.4, 0.2),
    "spinning circle": Circle((0.1, 0.2), 0.05, 1.3, spin_rad_s=-2.0),
    "sway": Sway((0, 0.1, 0, 0.2), (0.05, 0.02, 0.01, 0.5), 1.7, 0.3),
}
PATHS["sum"] = Sum((PATHS["straight"], PATHS["sway"], PATHS["circle"]))


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)
@pytest.mark.parametrize("time_s", [0.2, 0.77, 1.4, 2.6])
def test_rate_is_the_derivative(path, time_s):
    h = 1e-6
    slope = (path.at(time_s + h) - path.at(time_s - h)) / (2 * h)
    assert np.abs(path.rate(time_s) - slope).max() < 1e-8


def test_waypoints_rest_before_after_and_at_stops():
    stops = Waypoints((0.0, 1.0, 2.0, 3.0), ((0, 0, 0, 0), (0.1, 0, 0, 0), (0.1, 0, 0, 0), (0.2, 0.1, 0, 0)))
    assert np.array_equal(stops.at(-5), (0, 0, 0, 0))
    assert np.array_equal(stops.at(9), (0.2, 0.1, 0, 0))
    for time_s in (-1.0, 1.5, 3.0, 8.0):
        assert not stops.rate(time_s).any()
    assert np.allclose(stops.rate(2.0), (0.1, 0.1, 0, 0))  # the one that follows


@pytest.mark.parametrize(
    "make",
    [
        lambda: Waypoints((0.0,), ((0, 0, 0, 0),)),
        lambda: Waypoints((0.0, 0.0), ((0, 0, 0, 0), (1, 0, 0, 0))),
        lambda: Waypoints((0.0, 1.0), ((0, 0, 0, 0),)),
        lambda: Sway((0, 0, 0, 0), (0, 0, 0, 0), 0.0),
    ],
)
def test_impossible_paths_are_refused(make):
    with pytest.raises(BadParameter):
        make()
