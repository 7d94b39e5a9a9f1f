"""The chessboard: its points, its print, and its frame in every picture."""

import numpy as np
import pytest

from tests.chessboard_pictures import picture, posed
from vision_robot.calibrate.boards import BOARDS, Chessboard, board_named, raster
from vision_robot.errors import BadParameter

SCALE = 1600.0


def drawn(board: Chessboard) -> tuple[np.ndarray, np.ndarray]:
    """The print as a picture, and where its corners are."""
    corners = (board.points[:, :2] + board.origin_m) * SCALE - 0.5
    return raster(board.drawing(), SCALE), corners


def test_points_are_row_by_row_and_right_handed():
    """Id = row * columns + column; x along columns, y along rows, z = 0 on the face."""
    board = Chessboard(4, 3, 0.02)
    assert board.points.shape == (12, 3)
    assert board.points[0].tolist() == [0, 0, 0]
    assert board.points[5] == pytest.approx([0.02, 0.02, 0])
    assert board.points[11] == pytest.approx([0.06, 0.04, 0])


def test_drawing_has_black_first_square_and_a_quiet_margin():
    """Top left square black; every other square; nothing within a square of the page's upper rim."""
    board = Chessboard(9, 6, 0.025)
    page, _ = drawn(board)
    side = int(0.025 * SCALE)
    centres = page[side + side // 2 :: side, side + side // 2 :: side][:7, :10]
    row, column = np.indices(centres.shape)
    assert np.array_equal(centres == 0, (row + column) % 2 == 0)
    assert (page[:side] == 255).all()
    assert (page[:, :side] == 255).all()
    assert (page[:, -side:] == 255).all()
    assert board.size_m == pytest.approx((0.3, 0.225))


@pytest.mark.parametrize("size", [(9, 6), (6, 9), (8, 5), (7, 4), (4, 3), (12, 9)])
@pytest.mark.parametrize("turns", [0, 1, 2, 3])
def test_turned_pictures_give_ids_that_follow_the_board(size, turns):
    """Where one count is even and one odd, the colours fix the frame in every quarter turn."""
    board = Chessboard(size[0], size[1], 0.025)
    page, corners = drawn(board)
    for _ in range(turns):
        corners = np.stack([corners[:, 1], page.shape[1] - 1 - corners[:, 0]], axis=1)
        page = np.ascontiguousarray(np.rot90(page))
    found = board.detect(page, name="turned")
    assert found is not None
    assert found.image == "turned"
    assert found.ids.tolist() == list(range(len(board.points)))
    assert np.abs(found.pixels - corners).max() < 0.02


@pytest.mark.parametrize("size", [(8, 6), (7, 5), (7, 7), (6, 6)])
@pytest.mark.parametrize("turns", [0, 1, 2, 3])
def test_ambiguous_boards_lie_as_upright_as_they_can(size, turns):
    """x points as far to the right as colours and right-handedness allow, and black is first."""
    board = Chessboard(size[0], size[1], 0.025)
    page, _ = drawn(board)
    page = np.ascontiguousarray(np.rot90(page, turns))
    found = board.detect(page)
    assert found is not None
    grid = found.pixels.reshape(board.rows, board.columns, 2)
    x, y = grid[0, 1] - grid[0, 0], grid[1, 0] - grid[0, 0]
    assert x[0] * y[1] - x[1] * y[0] > 0
    first = grid[:2, :2].mean(axis=(0, 1)).round().astype(int)
    assert page[first[1], first[0]] == 0
    quarter_turned = abs(x[1]) > abs(x[0])
    # A quarter turn of 7 x 7 swaps the colours; of 8 x 6 it changes the shape.
    allowed = turns % 2 == 1 and size != (6, 6)
    assert quarter_turned == allowed
    assert quarter_turned or x[0] > 0


def test_mirrored_picture_still_has_a_right_handed_frame():
    """What is seen in a mirror is read as a board printed mirrored."""
    board = Chessboard(9, 6, 0.025)
    page, _ = drawn(board)
    found = board.detect(np.ascontiguousarray(page[:, ::-1]))
    assert found is not None
    grid = found.pixels.reshape(6, 9, 2)
    x, y = grid[0, 1] - grid[0, 0], grid[1, 0] - grid[0, 0]
    assert x[0] * y[1] - x[1] * y[0] > 0


def test_colour_pictures_and_grey_ones_agree():
    """Blue-green-red, with and without alpha, and one-channel pictures of the same thing."""
    board = Chessboard(6, 5, 0.02)
    shot = picture(posed(1, board=board, distance_m=0.22), board=board, noise=2)
    grey = board.detect(shot.grey)
    assert grey is not None
    for image in (np.dstack([shot.grey] * 3), np.dstack([shot.grey] * 4), shot.grey[..., None]):
        found = board.detect(image)
        assert found is not None
        assert np.abs(found.pixels - grey.pixels).max() < 0.02


@pytest.mark.parametrize(
    ("columns", "rows", "square"),
    [(2, 6, 0.02), (9, 0, 0.02), (9, 6, 0), (9, 6, -0.01), (9, 6, float("nan")), (9, 999, 1)],
)
def test_impossible_boards_are_refused(columns, rows, square):
    """Too few corners, fractions, zero and negative squares."""
    with pytest.raises(BadParameter, match="it must be"):
        Chessboard(columns, rows, square)


def test_registry_lists_what_it_knows():
    """Unknown names and unknown options are refused by name."""
    assert board_named("chessboard", (8, 5), 0.03) == Chessboard(8, 5, 0.03)
    with pytest.raises(BadParameter, match="chessboard") as caught:
        board_named("chess")
    assert all(name in str(caught.value) for name in BOARDS)
    with pytest.raises(BadParameter, match="marker"):
        board_named("chessboard", marker="tag36h11")
