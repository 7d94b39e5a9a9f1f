"""The target that --board, --size, --square and --board-option name."""

from collections.abc import Sequence

from vision_robot.calibrate.boards import Board, board_named
from vision_robot.errors import BadParameter
from vision_robot_cli.quantities import length_m, whole_pair

__all__ = ["target"]


def target(board: str, size: str, square: str, options: Sequence[str] = ()) -> Board:
    """The options --board, --size, --square and --board-option."""
    given: dict[str, float | str] = {}
    for word in options:
        name, equals, value = word.partition("=")
        if not equals:
            raise BadParameter("--board-option", word, "a name and a value, such as dictionary=DICT_4X4_50")
        try:
            given[name.strip()] = float(value)
        except ValueError:
            given[name.strip()] = value.strip()
    return board_named(board, whole_pair(size, "--size"), length_m(square, "--square"), **given)
