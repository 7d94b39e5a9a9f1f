"""From pictures to corners."""

import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from vision_robot.calibrate.boards import Board
from vision_robot.calibrate.boards.chessboard_finder import find_any_grid, grey_of
from vision_robot.calibrate.corners import Corners
from vision_robot.errors import MixedImageSizes
from vision_robot.types import Image

__all__ = ["detect_board", "detect_boards", "seen_size"]


def detect_board(image: Image, board: Board, *, name: str = "") -> Corners | None:
    """The board's points in a picture called `name`, or None where it is not seen.

    ``Corners.sigma_px`` is what the picture's own noise and blur leave open for each point.
    """
    return board.detect(image, name=name)


def detect_boards(
    images: Mapping[str, Any],  # of Image; reading one may raise, so it is left to the threads
    board: Board,
    *,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> list[Corners | None]:
    """The board's points in every picture, in order, None where it is not seen.

    `images` maps names to pictures, which are read as they are needed (an ImageSource). Threads do
    the work, one a core unless `workers` is given. ``progress(done, total)`` is called after each picture
    in this thread. Raises MixedImageSizes where pictures differ in size, and what `images` raises.
    """
    names = list(images)

    def look(name: str) -> tuple[Corners | None, tuple[int, int]]:
        image = images[name]
        return detect_board(image, board, name=name), (image.shape[1], image.shape[0])

    found: list[Corners | None] = []
    first_size = (0, 0)
    pool = ThreadPoolExecutor(workers or _cores())
    try:
        for done, (corners, size) in enumerate(pool.map(look, names), start=1):
            first_size = size if done == 1 else first_size
            if size != first_size:
                raise MixedImageSizes(names[0], first_size, names[done - 1], size)
            found.append(corners)
            if progress:
                progress(done, len(names))
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
    return found


def seen_size(image: Image) -> str | None:
    """Inner corners of whatever whole chessboard is in the picture, such as ``9x6``, longer side first.

    None where there is none. For an error's hint when the size asked for is not there.
    """
    grid = find_any_grid(grey_of(image))
    return None if grid is None else "x".join(str(count) for count in sorted(grid.shape[:2], reverse=True))


def _cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
