"""Shapes are convex, of the size asked for, lie on the table, and are one with their parts."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from vision_robot.errors import BadParameter
from vision_robot.sim.shapes import SHAPES, shape_named

SIZES = {
    "pencil": (0.15, 0.008),
    "rod": (0.12, 0.007),
    "hexagon": (0.1, 0.009),
    "box": (0.05, 0.03, 0.02),
    "disc": (0.06, 0.01),
}


def test_every_shape_is_tested():
    assert set(SIZES) == set(SHAPES)


@pytest.mark.parametrize("name", SIZES)
def test_it_is_convex_and_as_large_as_asked(name):
    shape = shape_named(name, SIZES[name], (0.5, 0.5, 0.5))
    hull = ConvexHull(shape.hull)
    inside = hull.equations[:, :3] @ np.concatenate([part.corners for part in shape.parts]).T
    assert (inside + hull.equations[:, 3:] < 1e-9).all()
    # The parts fill the hull: nothing is drawn hollow where the truth says body.
    assert sum(ConvexHull(part.corners).volume for part in shape.parts) == pytest.approx(
        hull.volume, rel=1e-9
    )
    low, high = shape.hull.min(axis=0), shape.hull.max(axis=0)
    assert low[2] == pytest.approx(-shape.rest_m)
    extent = high - low
    wanted = {
        "box": SIZES["box"],
        "disc": (0.06, 0.06, 0.01),
        "rod": (0.12, 0.007, 0.007),
        "hexagon": (0.1, 0.009 * 2 / np.sqrt(3), 0.009),
        "pencil": (0.15, 0.008 * 2 / np.sqrt(3), 0.008),
    }[name]
    assert np.abs(extent - wanted).max() < 1e-9
    assert shape.reach_m == pytest.approx(np.hypot(*shape.hull[:, :2].T).max())
    assert shape.has_yaw == (name != "disc")


@pytest.mark.parametrize(
    ("name", "size", "words"),
    [
        ("ball", (0.1,), "one of pencil"),
        ("box", (0.1, 0.1), "x, y, z"),
        ("disc", (0.0, 0.01), "from 0.001"),
        ("pencil", (0.03, 0.008), "at least 6 diameters"),
        ("rod", (0.009, 0.008), "at least 1.5 diameters"),
    ],
)
def test_what_cannot_be_made_is_refused(name, size, words):
    with pytest.raises(BadParameter, match=words):
        shape_named(name, size, (0.5, 0.5, 0.5))
