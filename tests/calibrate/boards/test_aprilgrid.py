"""AprilGrid: Kalibr's geometry, codes and order; corners exact; parts are enough."""

import numpy as np
import pytest

from tests.board_photos import facing, photo, rms, truth
from vision_robot.calibrate.boards import board_named, raster
from vision_robot.calibrate.boards.aprilgrid import AprilGrid
from vision_robot.calibrate.boards.charuco import Charuco
from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera

CAMERA = Camera(960, 720, 800, 805, 480, 355, 0, "brown5", (-0.28, 0.09, 1e-3, -5e-4, -0.01))
BOARD = AprilGrid(6, 5, 0.03)

FIRST_CODES = (0xD5D628584, 0xD97F18B49, 0xDD280910E)
"""Tags 0, 1 and 2 of family 36h11 as the makers of AprilTag publish them: most significant bit top left."""


def test_tags_are_kalibrs():
    """Border of two cells, published codes upright, tag 0 at the bottom left, ids to the right."""
    board = AprilGrid(3, 2, 0.03)
    page = raster(board.drawing(), 50 / 0.03, text=False)  # cells of 5 px, gaps of 15
    for tag, code in enumerate(FIRST_CODES):
        x, y = (np.array(board.origin_m) * 50 / 0.03).round().astype(int)
        left, top = x + tag * 65, y - 50
        cells = page[top : top + 50, left : left + 50][2::5, 2::5]
        assert set(np.unique(cells)) == {0, 255}
        assert (np.pad(cells[2:8, 2:8], 2) == cells).all()
        bits = "".join("1" if cell else "0" for cell in cells[2:8, 2:8].ravel())
        assert int(bits, 2) == code


def test_points_are_kalibrs():
    """The formula of GridCalibrationTargetAprilgrid::createGridPoints, with y and z turned over."""
    board = AprilGrid(3, 2, 0.088, 0.3)
    for r in range(4):
        for c in range(6):
            x = (c // 2) * 1.3 * 0.088 + (c % 2) * 0.088
            y = (r // 2) * 1.3 * 0.088 + (r % 2) * 0.088
            np.testing.assert_allclose(board.points[r * 6 + c], [x, -y, 0], atol=1e-12)


def test_every_corner_is_a_saddle_in_print():
    """Black in two opposite quadrants around each point, the tag's and the square's."""
    page = raster(BOARD.drawing(), 100 / 0.03, text=False)
    for x, y in (BOARD.points[:, :2] + BOARD.origin_m) * 100 / 0.03 - 0.5:
        u, v = round(x), round(y)
        diagonal, other = page[[v - 5, v + 5], [u - 5, u + 5]], page[[v - 5, v + 5], [u + 5, u - 5]]
        assert {tuple(diagonal), tuple(other)} == {(0, 0), (255, 255)}


@pytest.mark.parametrize("quarter_turns", range(4))
def test_own_print_is_found_turned(quarter_turns):
    """Ids name the same corner however the page is turned; positions to 0.05 px."""
    scale = 50 / BOARD.tag_m
    page = np.ascontiguousarray(np.rot90(raster(BOARD.drawing(), scale), quarter_turns))
    expected = (BOARD.points[:, :2] + BOARD.origin_m) * scale - 0.5
    size = round(BOARD.size_m[0] * scale), round(BOARD.size_m[1] * scale)
    for k in range(quarter_turns):
        expected = np.stack([expected[:, 1], size[k % 2] - 1 - expected[:, 0]], axis=1)
    seen = BOARD.detect(page)
    assert seen is not None
    assert seen.ids.tolist() == list(range(120))
    assert np.abs(seen.pixels - expected).max() < 0.05


@pytest.mark.parametrize(
    ("tilt", "blur_px", "noise", "limit"),
    [((0, 0), 0.5, 0, 0.01), ((0.6, 0.5), 0.5, 2, 0.02), ((0.4, -0.6), 1.2, 6, 0.05)],
)
def test_photo_through_a_lens(tilt, blur_px, noise, limit):
    """Tilted, blurred, noisy photos: nearly all corners, errors within the limit."""
    pose = facing(BOARD, CAMERA, tilt=tilt, roll=0.3)
    seen = BOARD.detect(photo(BOARD, CAMERA, pose, blur_px=blur_px, noise=noise))
    assert seen is not None
    assert len(seen) >= 112
    assert rms(seen.pixels - truth(BOARD, CAMERA, pose)[seen.ids]) < limit


def test_part_of_the_board_is_enough():
    """With most of the grid outside the picture the rest keeps its ids."""
    pose = facing(BOARD, CAMERA, fill=2.2, tilt=(0.3, 0.2), aim=(0.06, 0.03))
    seen = BOARD.detect(photo(BOARD, CAMERA, pose, noise=2))
    assert seen is not None
    assert 12 <= len(seen) < 100
    assert rms(seen.pixels - truth(BOARD, CAMERA, pose)[seen.ids]) < 0.05


def test_other_boards_are_not_taken_for_it():
    """Another width, tags with a border of one cell, nothing at all: None."""
    image = photo(BOARD, CAMERA, facing(BOARD, CAMERA, tilt=(0.3, 0.2)), noise=2)
    assert AprilGrid(5, 6, 0.03).detect(image) is None
    assert AprilGrid(7, 5, 0.03).detect(image) is None
    charuco = Charuco(9, 6, 0.03, dictionary="DICT_APRILTAG_36H11", marker_ratio=0.8)
    assert BOARD.detect(photo(charuco, CAMERA, facing(charuco, CAMERA))) is None
    assert BOARD.detect(np.random.default_rng(0).integers(0, 256, (480, 640), dtype=np.uint8)) is None


@pytest.mark.parametrize(
    ("size", "options", "named"),
    [
        ((0, 6), {}, "aprilgrid columns"),
        ((1, 1), {}, "aprilgrid size"),
        ((30, 30), {}, "aprilgrid size"),
        ((6, 6), {"spacing": 0.0}, "aprilgrid spacing"),
        ((6, 6), {"dictionary": "DICT_5X5_100"}, "aprilgrid options"),
    ],
)
def test_bad_parameters_are_named(size, options, named):
    """What cannot be built is refused with its name."""
    with pytest.raises(BadParameter, match=named):
        board_named("aprilgrid", size, 0.03, **options)
