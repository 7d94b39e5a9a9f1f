"""Boards are found in pictures: real ones, spoilt ones, wrong ones."""

from functools import cache
from importlib.resources import files

import cv2
import numpy as np
import pytest

from tests.chessboard_pictures import BOARD, disc, picture, posed
from vision_robot.calibrate.boards import Chessboard
from vision_robot.calibrate.detect import detect_board, detect_boards, seen_size
from vision_robot.errors import MixedImageSizes, UnreadableImage
from vision_robot.images import ImageSource, open_images

PHOTO_BOARD = Chessboard(9, 6, 0.025)


@cache
def photos() -> ImageSource:
    return open_images([f"{files('mvtbdata')}/images/calibration/left*.jpg"])


def test_every_photo_is_found_and_calibrates():
    """All 14; OpenCV's own calibration on these corners leaves 0.165 px per point, published: 0.39."""
    progress = []
    found = detect_boards(photos(), PHOTO_BOARD, progress=lambda done, total: progress.append((done, total)))
    assert [corners.image for corners in found if corners] == list(photos())
    assert progress == [(i, 14) for i in range(1, 15)]
    assert all(len(corners) == 54 and (corners.sigma_px < 0.1).all() for corners in found if corners)
    pixels = [corners.pixels.astype(np.float32) for corners in found if corners]
    points = [PHOTO_BOARD.points.astype(np.float32)] * len(pixels)
    rms, K, *_ = cv2.calibrateCamera(points, pixels, (640, 480), None, None)  # type: ignore[call-overload]
    assert rms < 0.165
    assert K[0, 0] == pytest.approx(533.6, abs=1.5)


def test_threads_do_not_change_results():
    """One thread or four: the same corners to the last bit."""
    few = {name: photos()[name] for name in list(photos())[:3]}
    one, four = (detect_boards(few, PHOTO_BOARD, workers=n) for n in (1, 4))
    for a, b in zip(one, four, strict=True):
        assert a is not None
        assert b is not None
        assert np.array_equal(a.pixels, b.pixels)


def test_wrong_size_is_not_found_but_seen():
    """Part of a board is not the board: 8x6 and 7x5 lie within 9x6."""
    photo = photos()["left01.jpg"]
    for size in ((8, 6), (7, 5), (9, 7)):
        assert detect_board(photo, Chessboard(*size, 0.025)) is None
    assert seen_size(photo) == "9x6"


def test_swapped_size_is_the_same_board():
    """A chessboard of 6x9 is one of 9x6 on its side."""
    upright = detect_board(photos()["left01.jpg"], PHOTO_BOARD)
    lying = detect_board(photos()["left01.jpg"], Chessboard(6, 9, 0.025))
    assert upright is not None
    assert lying is not None
    order = [np.lexsort(np.round(c.pixels).T) for c in (upright, lying)]
    assert np.abs(upright.pixels[order[0]] - lying.pixels[order[1]]).max() < 0.05


def test_nothing_is_seen_where_nothing_is():
    """Flat grey, noise and a gradient hold no board."""
    noise = np.random.default_rng(0).integers(0, 255, (240, 320), dtype=np.uint8)
    ramp = np.tile(np.linspace(0, 255, 320).astype(np.uint8), (240, 1))
    for blank in (np.full((240, 320), 90, np.uint8), noise, ramp):
        assert detect_board(blank, BOARD) is None
        assert seen_size(blank) is None


SPOILT = {
    "noisy": {"noise": 40},
    "faint": {"levels": (100, 112), "noise": 2},
    "blurred": {"blur": disc(6)},
    "overexposed": {"levels": (-200, 700), "blur": disc(1.5)},
    "inverted light": {"light": np.where(np.arange(480) < 200, 0.15, 1.0)},
}


@pytest.mark.parametrize("kind", SPOILT)
def test_spoilt_pictures_are_still_read(kind):
    """Corners within half a pixel; those a shadow's edge cuts through are left out rather than guessed."""
    for seed in (1, 2):
        shot = picture(posed(seed), **SPOILT[kind])
        found = detect_board(shot.grey, BOARD)
        assert found is not None
        assert len(found) >= 0.85 * len(BOARD.points)
        assert np.abs(found.pixels - shot.corners[found.ids]).max() < 0.5


def test_small_and_oblique_boards_are_read():
    """Squares of 6 px, and tilts of 70 degrees."""
    for pose in (posed(1, distance_m=1.3), posed(4, tilt_deg=(66, 70), distance_m=0.27)):
        shot = picture(pose, noise=1)
        found = detect_board(shot.grey, BOARD)
        assert found is not None
        assert np.abs(found.pixels - shot.corners[found.ids]).max() < 0.1


def test_large_pictures_lose_nothing_by_the_shrinking():
    """A picture four times as large gives the same corners, four times as large."""
    shot = picture(posed(1), blur=disc(1.0))
    large = cv2.resize(shot.grey, None, fx=5, fy=5, interpolation=cv2.INTER_CUBIC)
    found = detect_board(large, BOARD)
    assert found is not None
    assert np.abs((found.pixels + 0.5) / 5 - 0.5 - shot.corners).max() < 0.03


def test_mixed_sizes_are_refused_by_name():
    """The first picture and the first that differs are named, with their sizes."""
    shot = picture(posed(1)).grey
    with pytest.raises(MixedImageSizes, match=r"b is 240x180 px but a is 480x360 px"):
        detect_boards({"a": shot, "b": np.ascontiguousarray(shot[::2, ::2])}, BOARD)


def test_errors_of_reading_come_through(tmp_path):
    """A damaged file among good ones is named."""
    cv2.imwrite(str(tmp_path / "a.png"), picture(posed(1)).grey)
    (tmp_path / "b.png").write_bytes(b"")
    with pytest.raises(UnreadableImage, match=r"b\.png"):
        detect_boards(open_images([tmp_path]), BOARD)
