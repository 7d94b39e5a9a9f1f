"""From pictures to corners."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
import os

import numpy as np

from vision_robot.calibrate.boards import Board
from vision_robot.calibrate.corners import Corners
from vision_robot.types import Image

__all__ = ["detect_board"]


def detect_board(image: Image, board: Board, *, name: str = "") -> Corners | None:
    """The board's points in one picture, or None where it is not seen."""
    return board.detect(image, name=name)
