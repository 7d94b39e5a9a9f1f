"""Candidate poses: inside the picture, and as their words say."""

import numpy as np
import pytest

from tests.views import CAMERAS, grid_board
from vision_robot.calibrate.judgement.candidate_views import AWAY, candidate_views

BOARD = grid_board()


@pytest.mark.parametrize("model", CAMERAS)
def test_the_whole_board_lies_in_the_picture_with_its_border(model):
    camera = CAMERAS[model]
    views = candidate_views(camera, BOARD)
    assert len(views) > 90
    assert views.seen.all()
    bigger = grid_board(13, 10) - [0.03, 0.03, 0]
    assert camera.sees(views.cam_from_board.apply(np.broadcast_to(bigger, (len(views), 130, 3)))).all()


def test_the_named_edge_is_farther_from_the_camera():
    """The edge that the words send away from the camera is the far one, in every corner of the picture."""
    views = candidate_views(CAMERAS["brown5"], BOARD)
    points = BOARD.reshape(8, 11, 3)
    edges = {
        "left": points[:, 0],
        "right": points[:, -1],
        "top": points[0],
        "bottom": points[-1],
    }
    opposite = {"left": "right", "right": "left", "top": "bottom", "bottom": "top"}
    for i in map(int, np.flatnonzero(views.away >= 0)):
        away = list(AWAY)[views.away[i]]
        far, near = (
            np.linalg.norm(views.cam_from_board[i].apply(edges[name]), axis=1).mean()
            for name in (away, opposite[away])
        )
        assert far > near
        assert f"its {away} edge {round(np.degrees(views.tilt[i]))}° away" in views.words(i)


def test_tilt_is_against_the_line_of_sight():
    views = candidate_views(CAMERAS["brown5"], BOARD)
    middle = (BOARD.max(axis=0) + BOARD.min(axis=0)) / 2
    for i in range(len(views)):
        ray = views.cam_from_board[i].apply(middle[None])[0]
        cosine = views.cam_from_board[i].rotation[:, 2] @ ray / np.linalg.norm(ray)
        assert np.arccos(min(cosine, 1)) == pytest.approx(views.tilt[i], abs=1e-6)


def test_the_words_name_the_place():
    camera = CAMERAS["pinhole"]
    views = candidate_views(camera, BOARD)
    small = views.extent.max(axis=1) < 0.4
    for i in map(int, np.flatnonzero(small)):
        u, v = views.pixels[i].mean(axis=0) / (camera.width, camera.height)
        words = views.words(i)
        assert ("left" in words.split(" of the picture")[0]) == (u < 0.4)
        assert ("upper" in words) == (v < 0.4)


def test_coded_boards_may_stick_out():
    whole = candidate_views(CAMERAS["brown5"], BOARD)
    views = candidate_views(CAMERAS["brown5"], BOARD, whole=False)
    out = views.sticks_out
    assert len(views) > 1.5 * len(whole)
    assert (~views.seen[out].all(axis=1)).mean() > 0.9
    assert "sticking out" in views.words(int(np.flatnonzero(out)[0]))
