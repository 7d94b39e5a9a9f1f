"""Outlines and their moments: hand-worked areas, known ellipses, sampled pixels, and every lens."""

import numpy as np
import pytest

from vision_robot.geometry import SE3, Camera
from vision_robot.sim.outline import Moments, area_moments, clipped, outline_of, row_spans

PINHOLE = Camera(640, 480, 600, 590, 322.0, 236.0)
LENSES = {
    "pinhole": PINHOLE,
    "brown5": Camera(640, 480, 600, 590, 322, 236, 1.5, "brown5", (-0.2, 0.05, 0.001, -0.001, 0.0)),
    "fisheye": Camera(640, 480, 200, 202, 322, 236, 0.0, "fisheye", (0.01, 0.0, 0.0, 0.0)),
}
CUBE = 0.03 * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)


def test_a_rectangle_worked_by_hand():
    """4 x 2 about (10, 5): area 8, second moments 8 (16/12 + 100), 8 * 50, 8 (4/12 + 25)."""
    for polygon in (
        np.array([[8.0, 4], [12, 4], [12, 6], [8, 6]]),
        np.array([[8.0, 6], [12, 6], [12, 4], [8, 4]]),
    ):
        moments = area_moments(polygon)
        assert moments.area == pytest.approx(8)
        assert moments.centroid == pytest.approx((10, 5))
        assert moments.second == pytest.approx((8 * (16 / 12 + 100), 8 * 50, 8 * (4 / 12 + 25)))


def test_axes_of_a_turned_ellipse():
    """The second moments of an ellipse give back its own axes and direction."""
    angle = np.linspace(0, 2 * np.pi, 4000, endpoint=False)
    for turn in (-1.2, -0.3, 0.0, 0.7, 1.5):
        c, s = np.cos(turn), np.sin(turn)
        points = np.stack([20 * np.cos(angle), 6 * np.sin(angle)], axis=1) @ np.array([[c, s], [-s, c]])
        lengths, direction = area_moments(points + np.array([300, 200])).axes()
        assert lengths == pytest.approx((40, 12), rel=1e-5)
        assert direction == pytest.approx(turn, abs=1e-6)


def test_taking_pixels_away_is_the_same_as_not_having_them():
    """A 6 x 4 block of pixels less its right half is its left half."""
    block = area_moments(np.array([[-0.5, -0.5], [5.5, -0.5], [5.5, 3.5], [-0.5, 3.5]]))
    v, u = (index.ravel().astype(float) for index in np.mgrid[0:4, 3:6])
    rest = block.without(u, v)
    left = area_moments(np.array([[-0.5, -0.5], [2.5, -0.5], [2.5, 3.5], [-0.5, 3.5]]))
    assert rest.area == pytest.approx(left.area)
    assert rest.centroid == pytest.approx(left.centroid)
    assert rest.second == pytest.approx(left.second)
    assert isinstance(rest, Moments)


@pytest.mark.parametrize("name", LENSES)
def test_outline_holds_all_points_and_is_touched_by_its_corners(name):
    """Dense points of the cube lie inside its outline, and the area is that of the counted pixels."""
    camera = LENSES[name]
    pose = SE3.from_rotvec(np.array([0.5, -0.4, 0.9]), np.array([0.06, -0.04, 0.4]))
    polygon = outline_of(pose.apply(CUBE), camera)
    assert polygon is not None
    grid = np.linspace(-1, 1, 61)
    faces = np.stack(np.meshgrid(grid, grid), -1).reshape(-1, 2)
    ones = np.ones((len(faces), 1))
    dense = np.concatenate(
        [np.insert(faces, axis, sign * ones.T, axis=1) for axis in range(3) for sign in (-1, 1)]
    )
    pixels = camera.project(pose.apply(0.03 * dense))
    assert pixels.min(axis=0) == pytest.approx(polygon.min(axis=0), abs=0.02)
    assert pixels.max(axis=0) == pytest.approx(polygon.max(axis=0), abs=0.02)
    top, low, high = row_spans(polygon)
    counted = np.maximum(high - low + 1, 0)
    assert counted.sum() == pytest.approx(area_moments(polygon).area, rel=0.01)
    for row, first, last in zip(range(top, top + len(low)), low, high, strict=True):
        near = pixels[np.abs(pixels[:, 1] - row) < 0.3, 0]
        if len(near) > 3 and last >= first:
            assert first - 1.5 < near.min()
            assert near.max() < last + 1.5


def test_a_body_behind_a_fisheye_has_an_outline_too():
    wide = Camera(400, 400, 60, 60, 199.5, 199.5, 0.0, "fisheye", (0, 0, 0, 0))
    pose = SE3(np.eye(3), np.array([0.5, 0.1, -0.15]))
    polygon = outline_of(pose.apply(CUBE), wide)
    assert polygon is not None
    assert np.abs(area_moments(polygon).centroid - wide.project(pose.translation)).max() < 1


def test_no_outline_where_a_point_is_not_imaged():
    assert outline_of(CUBE + np.array([0, 0, 0.02]), PINHOLE) is None  # the camera is inside
    assert outline_of(CUBE + np.array([0, 0, -0.5]), PINHOLE) is None  # behind it


def test_clipping_keeps_what_is_inside():
    square = np.array([[-10.0, -10], [10, -10], [10, 10], [-10, 10]])
    assert clipped(square + 50, 100, 80) is not None
    assert area_moments(clipped(square, 100, 80)).area == pytest.approx(10.5**2)
    assert area_moments(clipped(square + np.array([99.5, 79.5]), 100, 80)).area == pytest.approx(100)
    assert area_moments(clipped(square * 50, 100, 80)).area == pytest.approx(8000)
    assert len(clipped(square - 50, 100, 80)) < 3
    diamond = np.array([[0.0, -20], [20, 0], [0, 20], [-20, 0]]) - 0.5
    assert area_moments(clipped(diamond, 100, 80)).area == pytest.approx(200)


def test_spans_are_the_pixels_whose_centres_lie_inside():
    polygon = np.array([[1.2, 0.1], [7.9, 3.0], [4.0, 6.4]])
    top, low, high = row_spans(polygon)
    from matplotlib.path import Path

    inside = Path(polygon).contains_points(
        np.stack(np.meshgrid(np.arange(9), np.arange(8)), -1).reshape(-1, 2)
    )
    mine = np.zeros((8, 9), dtype=bool)
    for row, first, last in zip(range(top, top + len(low)), low, high, strict=True):
        mine[row, first : last + 1] = True
    # The corner (7.9, 3.0) lies on a row itself: whether its own point counts is a matter of taste.
    assert (mine != inside.reshape(8, 9)).sum() == 0
