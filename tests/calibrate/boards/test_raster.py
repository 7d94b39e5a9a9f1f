"""Rasters are exact by area and lie where they say."""

import numpy as np
import pytest

from vision_robot.calibrate.boards import Disc, Drawing, Polygon, raster
from vision_robot.errors import BadParameter


def ink(drawing: Drawing, scale: float) -> float:
    """Total ink in pixels."""
    return float((1 - raster(drawing, scale) / 255).sum())


def test_rectangle_covers_pixels_by_area():
    """A rectangle from (0.5, 0.25) to (2, 1.5) px shades each pixel by its share."""
    page = raster(Drawing(3, 2, (Polygon.rectangle(0.5, 0.25, 1.5, 1.25),)), 1.0)
    share = np.outer([0.75, 0.5], [0.5, 1, 0])
    assert np.array_equal(page, np.rint(255 * (1 - share)).astype(np.uint8))


def test_squares_that_meet_in_a_pixel_add():
    """Two diagonal neighbours of a chessboard, each a quarter of the pixel they share."""
    squares = (Polygon.rectangle(0, 0, 1.5, 1.5), Polygon.rectangle(1.5, 1.5, 1.5, 1.5))
    assert raster(Drawing(3, 3, squares), 1.0)[1, 1] == round(255 * 0.5)


@pytest.mark.parametrize("radius", [0.4, 3.3, 20.2])
def test_disc_has_its_area_and_centroid(radius):
    """π r², wherever the centre lies between pixels."""
    centre = (24.31, 25.77)
    page = 1 - raster(Drawing(50, 50, (Disc(centre, radius),)), 1.0) / 255
    assert page.sum() == pytest.approx(np.pi * radius**2, rel=1e-2)
    if radius < 1:
        return  # rounded to whole grey levels, three pixels say no more
    v, u = np.indices(page.shape)
    assert (page * u).sum() / page.sum() == pytest.approx(centre[0] - 0.5, abs=5e-3)
    assert (page * v).sum() / page.sum() == pytest.approx(centre[1] - 0.5, abs=5e-3)


def test_triangle_has_its_area():
    """General polygons too, at any scale."""
    triangle = Polygon(((0.1, 0.2), (0.9, 0.35), (0.4, 0.8)))
    for scale in (10, 33.3, 100):
        assert ink(Drawing(1, 1, (triangle,)), scale) / scale**2 == pytest.approx(0.2175, rel=3e-3)


def test_white_shape_inside_black_takes_ink_away():
    """A ring: disc minus disc."""
    ring = (Disc((0.5, 0.5), 0.4), Disc((0.5, 0.5), 0.2, black=False))
    assert ink(Drawing(1, 1, ring), 100) == pytest.approx(np.pi * 0.12 * 1e4, rel=2e-3)


def test_size_is_rounded_up_and_impossible_ones_are_refused():
    """A page of 10.2 x 5 px needs 11 columns; no scale of zero, no terabytes."""
    assert raster(Drawing(1.02, 0.5, ()), 10).shape == (5, 11)
    for scale in (0, -1, float("nan"), 1e9):
        with pytest.raises(BadParameter):
            raster(Drawing(1, 1, ()), scale)
