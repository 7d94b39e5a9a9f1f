"""Asymmetric circles: OpenCV's geometry, one order in every picture, exact centres."""

import numpy as np
import pytest

from tests.board_photos import facing, photo, rms, truth
from vision_robot.calibrate.boards import board_named, raster
from vision_robot.calibrate.boards.acircles import AsymmetricCircles
from vision_robot.calibrate.circle_bias import centre_offsets
from vision_robot.geometry import Camera

CAMERA = Camera(960, 720, 800, 805, 480, 355, 0, "brown5", (-0.28, 0.09, 1e-3, -5e-4, -0.01))
BOARD = AsymmetricCircles(4, 11, 0.02, 0.014)


def test_points_are_opencvs():
    """The formula of OpenCV's calibration samples: ((2 j + i % 2) s, i s) for i in rows, j in columns."""
    expected = [((2 * j + i % 2) * 0.02, i * 0.02, 0) for i in range(11) for j in range(4)]
    np.testing.assert_allclose(BOARD.points, expected, atol=1e-12)
    assert isinstance(board_named("acircles", (4, 11), 0.02), AsymmetricCircles)


@pytest.mark.parametrize("quarter_turns", range(4))
def test_own_print_is_found_turned(quarter_turns):
    """Ids name the same disc however the page is turned."""
    scale = 30 / BOARD.spacing_m
    page = np.ascontiguousarray(np.rot90(raster(BOARD.drawing(), scale), quarter_turns))
    expected = (BOARD.points[:, :2] + BOARD.origin_m) * scale - 0.5
    size = round(BOARD.size_m[0] * scale), round(BOARD.size_m[1] * scale)
    for k in range(quarter_turns):
        expected = np.stack([expected[:, 1], size[k % 2] - 1 - expected[:, 0]], axis=1)
    seen = BOARD.detect(page)
    assert seen is not None
    assert seen.ids.tolist() == list(range(44))
    assert np.abs(seen.pixels - expected).max() < 0.01


@pytest.mark.parametrize("degrees", [35, 130, -100, 180])
def test_photo_through_a_lens(degrees):
    """Rolled, tilted, noisy: the same ids, and the truth once corrected."""
    pose = facing(BOARD, CAMERA, fill=0.7, tilt=(0.5, 0.4), roll=np.deg2rad(degrees))
    seen = BOARD.detect(photo(BOARD, CAMERA, pose, noise=3))
    assert seen is not None
    assert len(seen) == 44
    errors = seen.pixels - truth(BOARD, CAMERA, pose)
    assert rms(errors) > 0.05
    assert rms(errors - centre_offsets(CAMERA, pose, BOARD.points, BOARD.radius_m)) < 0.02


def test_other_sizes_are_not_taken_for_it():
    """One row or column more or less: None."""
    image = photo(BOARD, CAMERA, facing(BOARD, CAMERA, tilt=(0.3, 0.2)), noise=2)
    for columns, rows in ((4, 10), (4, 9), (5, 11), (3, 11), (11, 4)):
        assert AsymmetricCircles(columns, rows, 0.02, 0.014).detect(image) is None
