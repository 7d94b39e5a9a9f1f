"""Calibration targets: their points, their print and how they are found in a picture.

To add a target, write one file with a `Board` and add its line to `BOARDS`.
"""

from importlib import import_module

from vision_robot.calibrate.boards.board import Board
from vision_robot.calibrate.boards.chessboard import Chessboard
from vision_robot.calibrate.boards.drawing import Disc, Drawing, Polygon, TextLine
from vision_robot.calibrate.boards.raster import raster
from vision_robot.errors import BadParameter

__all__ = [
    "BOARDS",
    "Board",
    "Chessboard",
    "Disc",
    "Drawing",
    "Polygon",
    "TextLine",
    "board_named",
    "raster",
]

BOARDS: dict[str, str] = {
    "chessboard": "vision_robot.calibrate.boards.chessboard:Chessboard",
    "charuco": "vision_robot.calibrate.boards.charuco:Charuco",
    "circles": "vision_robot.calibrate.boards.circles:Circles",
    "acircles": "vision_robot.calibrate.boards.acircles:AsymmetricCircles",
    "aprilgrid": "vision_robot.calibrate.boards.aprilgrid:AprilGrid",
}


def board_named(
    name: str, size: tuple[int, int] = (9, 6), square_m: float = 0.025, **options: float | str
) -> Board:
    """The target of that name: `size` = (columns, rows), pitch `square_m` [m] and its own options.

    Raises BadParameter for unknown names (listing the known), options the target does not have,
    and sizes it cannot have.
    """
    if name not in BOARDS:
        raise BadParameter("board", name, f"one of {', '.join(BOARDS)}")
    module, kind = BOARDS[name].split(":")
    board_class: type[Board] = getattr(import_module(module), kind)
    return board_class.of_size(size, square_m, **options)
