"""ChArUco: the print is OpenCV's, ids are OpenCV's, corners are exact, parts are enough."""

import cv2
import numpy as np
import pytest

from tests.board_photos import facing, photo, rms, truth
from vision_robot.calibrate.boards import board_named, raster
from vision_robot.calibrate.boards.charuco import Charuco
from vision_robot.calibrate.boards.chessboard import Chessboard
from vision_robot.calibrate.boards.marker import dictionary_named
from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera

CAMERA = Camera(960, 720, 800, 805, 480, 355, 0, "brown5", (-0.28, 0.09, 1e-3, -5e-4, -0.01))
BOARD = Charuco(9, 6, 0.03)


@pytest.mark.parametrize(
    ("size", "dictionary", "ratio", "legacy"),
    [
        ((9, 6), "DICT_5X5_100", 0.7, False),
        ((8, 6), "4x4_50", 0.6, True),
        ((5, 7), "DICT_6X6_250", 0.8, True),
        ((8, 6), "APRILTAG_36h11", 0.8, False),
        ((12, 9), "DICT_7X7_100", 0.7, False),
    ],
)
def test_print_is_opencvs(size, dictionary, ratio, legacy):
    """Pixel for pixel what CharucoBoard.generateImage draws, legacy pattern included."""
    board = Charuco.of_size(size, 0.03, dictionary=dictionary, marker_ratio=ratio, legacy=int(legacy))
    words = dictionary_named(dictionary)
    square = 20 * (words.markerSize + 2)  # cells and the margins around markers are whole pixels
    theirs = cv2.aruco.CharucoBoard(size, 0.03, 0.03 * ratio, words)
    theirs.setLegacyPattern(legacy)
    expected = theirs.generateImage((size[0] * square, size[1] * square), marginSize=0)
    ours = raster(board.drawing(), square / 0.03, text=False)
    assert (ours[square : square + len(expected), square : square + expected.shape[1]] == expected).all()
    corners = np.asarray(theirs.getChessboardCorners()).reshape(-1, 3) - [0.03, 0.03, 0]
    np.testing.assert_allclose(board.points, corners, atol=1e-7)


@pytest.mark.parametrize("quarter_turns", range(4))
def test_own_print_is_found_turned(quarter_turns):
    """Ids name the same corner however the page is turned; positions to 0.05 px."""
    scale = 40 / BOARD.square_m
    page = np.ascontiguousarray(np.rot90(raster(BOARD.drawing(), scale), quarter_turns))
    expected = (BOARD.points[:, :2] + BOARD.origin_m) * scale - 0.5
    width = round(BOARD.size_m[0] * scale), round(BOARD.size_m[1] * scale)
    for k in range(quarter_turns):
        expected = np.stack([expected[:, 1], width[k % 2] - 1 - expected[:, 0]], axis=1)
    seen = BOARD.detect(page)
    assert seen is not None
    assert seen.ids.tolist() == list(range(40))
    assert np.abs(seen.pixels - expected).max() < 0.05


@pytest.mark.parametrize(
    ("tilt", "blur_px", "noise", "limit"),
    [
        ((0, 0), 0.5, 0, 0.01),
        ((0.6, 0.5), 0.5, 2, 0.02),
        ((0.9, 0.3), 0.7, 4, 0.05),
        ((0.4, -0.6), 1.5, 8, 0.05),
    ],
)
def test_photo_through_a_lens(tilt, blur_px, noise, limit):
    """Tilted, blurred, noisy photos: nearly all corners, errors within the limit, an honest sigma."""
    pose = facing(BOARD, CAMERA, tilt=tilt, roll=0.3)
    seen = BOARD.detect(photo(BOARD, CAMERA, pose, blur_px=blur_px, noise=noise))
    assert seen is not None
    assert len(seen) >= 36
    errors = seen.pixels - truth(BOARD, CAMERA, pose)[seen.ids]
    assert rms(errors) < limit
    assert rms(errors / seen.sigma_px[:, None]) < 2.5


def test_part_of_the_board_is_enough():
    """With most of the board outside the picture the rest keeps its ids."""
    pose = facing(BOARD, CAMERA, fill=2.0, tilt=(0.3, 0.2), aim=(0.06, 0.03))
    seen = BOARD.detect(photo(BOARD, CAMERA, pose, noise=2))
    assert seen is not None
    assert 6 <= len(seen) < 35
    assert rms(seen.pixels - truth(BOARD, CAMERA, pose)[seen.ids]) < 0.05


def test_hidden_corners_are_left_out():
    """Something in front of the board removes corners and moves none."""
    pose = facing(BOARD, CAMERA, tilt=(0.3, 0.2))
    image = photo(BOARD, CAMERA, pose, noise=2)
    image[250:400, 300:520] = 90
    seen = BOARD.detect(image)
    assert seen is not None
    expected = truth(BOARD, CAMERA, pose)
    hidden = np.all((expected > [300, 250]) & (expected < [519, 399]), axis=1)
    assert hidden.any()
    assert not hidden[seen.ids].any()
    assert np.abs(seen.pixels - expected[seen.ids]).max() < 0.1


def test_other_boards_are_not_taken_for_it():
    """Another width, another dictionary, no markers, nothing at all: None."""
    pose = facing(BOARD, CAMERA, tilt=(0.3, 0.2))
    image = photo(BOARD, CAMERA, pose, noise=2)
    for other in (Charuco(8, 6, 0.03), Charuco(6, 9, 0.03), Charuco(9, 6, 0.03, dictionary="DICT_4X4_50")):
        assert other.detect(image) is None
    chessboard = Chessboard(8, 5, 0.03)
    assert BOARD.detect(photo(chessboard, CAMERA, facing(chessboard, CAMERA))) is None
    noise = np.random.default_rng(0).integers(0, 256, (480, 640), dtype=np.uint8)
    assert BOARD.detect(noise) is None
    assert BOARD.detect(np.full((480, 640), 128, np.uint8)) is None


def test_size_means_squares_and_says_so():
    """9x6 are squares, as for cv2.aruco.CharucoBoard; the print says both counts."""
    board = board_named("charuco", (9, 6), 0.025)
    assert board.size == "9x6"
    assert len(board.points) == 8 * 5
    assert board.description == (
        "ChArUco 9x6 squares (8x5 inner corners), squares 25 mm, markers 17.5 mm, DICT_5X5_100"
    )
    assert board.description in board.drawing().texts[0].text


@pytest.mark.parametrize(
    ("size", "options", "named"),
    [
        ((2, 6), {}, "charuco columns"),
        ((9, 6), {"dictionary": "DICT_9X9"}, "dictionary"),
        ((20, 20), {}, "dictionary"),
        ((9, 6), {"marker_ratio": 1.2}, "marker ratio"),
        ((9, 6), {"spacing": 0.3}, "charuco options"),
    ],
)
def test_bad_parameters_are_named(size, options, named):
    """What cannot be built is refused with its name."""
    with pytest.raises(BadParameter, match=named):
        board_named("charuco", size, 0.03, **options)
