"""Symmetric circles: found turned, tilted, blurred, noisy; centres exact; wrong sizes refused."""

import numpy as np
import pytest

from tests.board_photos import facing, photo, rms, truth
from vision_robot.calibrate.boards import board_named, raster
from vision_robot.calibrate.boards.acircles import AsymmetricCircles
from vision_robot.calibrate.boards.chessboard import Chessboard
from vision_robot.calibrate.boards.circles import Circles
from vision_robot.calibrate.circle_bias import centre_offsets
from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera

CAMERA = Camera(960, 720, 800, 805, 480, 355, 0, "brown5", (-0.28, 0.09, 1e-3, -5e-4, -0.01))
BOARD = Circles(9, 6, 0.03, 0.015)


@pytest.mark.parametrize("pixels_per_spacing", [14, 40])
def test_own_print_is_found(pixels_per_spacing):
    """Centres to 0.01 px at seven and at twenty pixels across a disc."""
    scale = pixels_per_spacing / BOARD.spacing_m
    seen = BOARD.detect(raster(BOARD.drawing(), scale))
    assert seen is not None
    assert seen.ids.tolist() == list(range(54))
    expected = (BOARD.points[:, :2] + BOARD.origin_m) * scale - 0.5
    assert np.abs(seen.pixels - expected).max() < 0.01


@pytest.mark.parametrize("degrees", [-150, -80, 0, 80, 100, 170])
def test_half_a_turn_is_resolved_by_the_rule(degrees):
    """The order is the print's or the one after half a turn: whichever has its x axis to the right."""
    pose = facing(BOARD, CAMERA, fill=0.6, roll=np.deg2rad(degrees), tilt=(0.2, 0.1))
    seen = BOARD.detect(photo(BOARD, CAMERA, pose))
    assert seen is not None
    expected = truth(BOARD, CAMERA, pose)
    if abs(degrees) > 90:
        expected = expected[::-1]
    assert np.abs(seen.pixels - expected).max() < 1


@pytest.mark.parametrize(
    ("tilt", "blur_px", "noise", "limit"),
    [
        ((0, 0), 0.5, 0, 0.01),
        ((0.6, 0.5), 0.5, 2, 0.01),
        ((0.9, 0.3), 2.0, 4, 0.03),
        ((0.5, -0.5), 0.5, 10, 0.03),
    ],
)
def test_photo_through_a_lens(tilt, blur_px, noise, limit):
    """Once corrected for perspective and lens, centres lie on the truth, with an honest sigma."""
    pose = facing(BOARD, CAMERA, tilt=tilt)
    seen = BOARD.detect(photo(BOARD, CAMERA, pose, blur_px=blur_px, noise=noise))
    assert seen is not None
    assert len(seen) == 54
    offsets = centre_offsets(CAMERA, pose, BOARD.points, BOARD.radius_m)
    errors = seen.pixels - truth(BOARD, CAMERA, pose) - offsets
    assert rms(errors) < limit
    assert rms(errors / seen.sigma_px[:, None]) < 1.5


def test_uneven_light_moves_nothing():
    """A slope of brightness over the picture, three to one, shifts no centre by more than 0.02 px."""
    pose = facing(BOARD, CAMERA, tilt=(0.4, 0.3))
    image = photo(BOARD, CAMERA, pose)
    light = np.linspace(0.35, 1.05, image.shape[1])
    seen = BOARD.detect(np.clip(image * light, 0, 255).astype(np.uint8))
    assert seen is not None
    offsets = centre_offsets(CAMERA, pose, BOARD.points, BOARD.radius_m)
    assert rms(seen.pixels - (truth(BOARD, CAMERA, pose) + offsets)[seen.ids]) < 0.02


def test_other_boards_are_not_taken_for_it():
    """Another size, a chessboard, an asymmetric grid, noise, nothing: None."""
    image = photo(BOARD, CAMERA, facing(BOARD, CAMERA, tilt=(0.3, 0.2)), noise=2)
    assert Circles(8, 6, 0.03, 0.015).detect(image) is None
    assert Circles(9, 7, 0.03, 0.015).detect(image) is None
    for other in (Chessboard(9, 6, 0.03), AsymmetricCircles(9, 6, 0.02, 0.012)):
        assert BOARD.detect(photo(other, CAMERA, facing(other, CAMERA))) is None
    assert BOARD.detect(np.random.default_rng(0).integers(0, 256, (240, 320), dtype=np.uint8)) is None
    assert BOARD.detect(np.full((480, 640), 128, np.uint8)) is None


@pytest.mark.parametrize(
    ("size", "options", "named"),
    [
        ((2, 6), {}, "circles columns"),
        ((9, 6), {"diameter_m": 0.03}, "circles diameter"),
        ((9, 6), {"dictionary": "x"}, "circles options"),
    ],
)
def test_bad_parameters_are_named(size, options, named):
    """What cannot be built is refused with its name."""
    with pytest.raises(BadParameter, match=named):
        board_named("circles", size, 0.03, **options)
