"""Plain-text corner sets: read as numbers in pairs, refused in words that name file and line."""

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import calibrate
from vision_robot.calibrate.corner_files import read_corner_folder, read_model_points, size_holding
from vision_robot.errors import BadCornerFile, BadParameter


def write(path, pairs, per_line=4):
    words = [repr(float(x)) for x in np.ravel(pairs)]
    lines = [" ".join(words[i : i + per_line]) for i in range(0, len(words), per_line)]
    path.write_text("\n".join(lines) + "\n")


def test_a_set_on_disk_calibrates_as_the_set_in_memory(tmp_path):
    views = make_views(CAMERAS["brown5"], 5)
    (tmp_path / "views").mkdir()
    for i, view in enumerate(views.corners):
        write(tmp_path / "views" / f"data{i}.txt", view.pixels, per_line=8)
    write(tmp_path / "model.txt", views.board[:, :2])
    board = read_model_points(tmp_path / "model.txt")
    corners = read_corner_folder(tmp_path / "views", len(board))
    assert [view.image for view in corners] == [f"data{i}.txt" for i in range(5)]
    assert size_holding(corners) == (1280, 960)
    result = calibrate(corners, board, (1280, 960))
    expected = calibrate(views.corners, views.board, (1280, 960))
    np.testing.assert_array_equal(result.camera.parameters, expected.camera.parameters)


def test_the_model_may_lie_in_the_same_folder(tmp_path):
    write(tmp_path / "model.txt", [[0, 0], [1, 0], [0, 1]])
    write(tmp_path / "a.txt", [[10, 10], [20, 10], [10, 20]])
    assert len(read_corner_folder(tmp_path, 3, leave_out=[tmp_path / "model.txt"])) == 1


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("1 2 3", "3 numbers where x, y pairs belong"),
        ("", "0 numbers"),
        ("1 2\n3 four", "line 2 holds 'four'"),
        ("1 nan 3 4", "not finite"),
        ("0 0 1 1", "2 points where the model has 3"),
        ("5 5 1 1 5 5", "two of its corners lie at the same place"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, content, says):
    (tmp_path / "a.txt").write_text(content)
    with pytest.raises(BadCornerFile, match=says):
        read_corner_folder(tmp_path, 3)


def test_binary_files_and_missing_folders_are_refused(tmp_path):
    (tmp_path / "a.txt").write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(BadCornerFile, match="not text"):
        read_corner_folder(tmp_path, 3)
    with pytest.raises(BadParameter, match="a folder"):
        read_corner_folder(tmp_path / "nowhere", 3)
    with pytest.raises(BadCornerFile, match="no such file"):
        read_model_points(tmp_path / "nowhere.txt")


def test_equal_board_points_are_refused(tmp_path):
    write(tmp_path / "model.txt", [[0, 0], [1, 0], [0, 0]])
    with pytest.raises(BadCornerFile, match="the same"):
        read_model_points(tmp_path / "model.txt")
