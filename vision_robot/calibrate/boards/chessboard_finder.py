"""Finding a chessboard: a cascade of OpenCV's detectors, cheapest first.

No one detector finds every photo. Each attempt is a picture derived from the photo and a
detector; a find counts only if the colours around its corners are those of a whole board.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.calibrate.boards.chessboard_order import canonical_grid, is_whole_board
from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.grid_shape import strays, without_strays
from vision_robot.calibrate.saddle import fit_grid
from vision_robot.types import Array, Float, Image, UInt8

__all__ = ["find_any_grid", "find_chessboard", "find_grid", "grey_of"]

Grey = UInt8[Array, "height width"]
Grid = Float[Array, "rows columns 2"]
Size = tuple[int, int]

QUICK = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_FAST_CHECK
PATIENT = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE
FILTERED = PATIENT | cv2.CALIB_CB_FILTER_QUADS
SECTOR = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY
SECTOR_PATIENT = SECTOR | cv2.CALIB_CB_EXHAUSTIVE

SMALL_PX, LARGE_PX = 800, 1600
"""Long sides to which larger pictures are shrunk for the quick and for the patient attempts."""


def grey_of(image: Image) -> Grey:
    """Grey picture of a grey, blue-green-red or blue-green-red-alpha one."""
    if image.ndim == 2:
        return image
    if image.shape[2] == 1:
        return image[..., 0]
    return cv2.cvtColor(image, cv2.COLOR_BGRA2GRAY if image.shape[2] == 4 else cv2.COLOR_BGR2GRAY)


def find_chessboard(image: Image, size: Size, *, name: str = "") -> Corners | None:
    """Corners of the board of `size` = (columns, rows) in its canonical order, or None.

    Corners that a shadow or a stain keeps from being measured are left out.
    """
    grey = grey_of(image)
    grid = find_grid(grey, size)
    if grid is None:
        return None
    grid = without_strays(canonical_grid(grey, grid, size))
    saddles = fit_grid(grey, grid)
    sure = saddles.fitted & ~strays(saddles.pixels.reshape(grid.shape))
    return Corners(name, np.flatnonzero(sure), saddles.pixels[sure], saddles.sigma_px[sure])


def find_grid(grey: Grey, size: Size) -> Grid | None:
    """First find of the cascade that is a whole board, in the order of whichever detector made it.

    A whole board of another size ends the search: what is asked for is not there.
    """
    for attempt in _quick(grey):
        if (grid := attempt.found(grey, size)) is not None:
            return grid
    any_grid = find_any_grid(grey)
    if any_grid is not None:
        right = sorted(any_grid.shape[:2]) == sorted(size)
        return _whole(grey, size, _refitted(any_grid, size)) if right else None
    for attempt in _patient(grey):
        if (grid := attempt.found(grey, size)) is not None:
            return grid
    return None


def find_any_grid(grey: Grey) -> Grid | None:
    """Corners of a whole chessboard of any size, or None: grown from any 3 × 3 corners."""
    small = _resized(grey, _shrinking(grey, LARGE_PX))
    for more in (0, cv2.CALIB_CB_EXHAUSTIVE):
        flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_LARGER | more
        found, pixels, meta = cv2.findChessboardCornersSBWithMeta(small, (3, 3), flags)
        if found:
            grid = np.asarray(pixels, dtype=float).reshape(*meta.shape, 2)
            if is_whole_board(small, grid):
                return _original(grid.reshape(-1, 2), small, grey).reshape(grid.shape)
    return None


@dataclass(frozen=True)
class _Attempt:
    """A detector, the scales (across, down) at which it looks, and what is done to the picture before."""

    detect: "Detector"
    scale: tuple[float, float]
    altered: Callable[[Grey], Grey] | None = None

    def found(self, grey: Grey, size: Size) -> Grid | None:
        """The whole board in the picture, or None."""
        small = _resized(grey, self.scale)
        pixels = self.detect(self.altered(small) if self.altered else small, size)
        if pixels is None:
            return None
        if max(self.scale) < 1:
            # A small picture's errors grow with the picture: make them small before.
            columns, rows = size
            pixels = fit_grid(small, pixels.reshape(rows, columns, 2)).pixels
        return _whole(grey, size, _original(pixels, small, grey))


def _quick(grey: Grey) -> Iterator[_Attempt]:
    """What finds nearly all boards."""
    small = _shrinking(grey, SMALL_PX)
    yield _Attempt(_quads(QUICK), small)
    yield _Attempt(_sectors(SECTOR), small)
    # Before any verdict on size: the lit part of a board in hard shadow looks like a smaller board.
    yield _Attempt(_sectors(SECTOR_PATIENT), small, _levelled)


def _patient(grey: Grey) -> Iterator[_Attempt]:
    """What finds boards that are faint, noisy, blurred, small or very oblique."""
    long_side = max(grey.shape)
    large, small = _shrinking(grey, LARGE_PX), _shrinking(grey, SMALL_PX)
    yield _Attempt(_sectors(SECTOR_PATIENT), large)
    yield _Attempt(_quads(PATIENT), large)
    yield _Attempt(_quads(FILTERED), small, lambda picture: cv2.medianBlur(_stretched(picture), 5))
    # Magnified along one axis, foreshortened squares become squares again.
    for scale in ((2.0, 2.0), (1.0, 2.0), (2.0, 1.0), (1.0, 3.0), (3.0, 1.0)):
        if max(scale) * long_side <= LARGE_PX:
            yield _Attempt(_quads(PATIENT), scale, _stretched)


def _whole(grey: Grey, size: Size, pixels: Float[Array, "n 2"]) -> Grid | None:
    columns, rows = size
    if len(pixels) != columns * rows:
        return None
    grid = pixels.reshape(rows, columns, 2)
    return grid if is_whole_board(grey, grid) else None


Detector = Callable[[Grey, Size], Float[Array, "n 2"] | None]


def _quads(flags: int) -> Detector:
    def detect(grey: Grey, size: Size) -> Float[Array, "n 2"] | None:
        found, pixels = cv2.findChessboardCorners(grey, size, flags=flags)
        if not found:
            return None
        return refined_by_gradients(grey, np.asarray(pixels, dtype=float).reshape(-1, 2), size)

    return detect


def _sectors(flags: int) -> Detector:
    def detect(grey: Grey, size: Size) -> Float[Array, "n 2"] | None:
        found, pixels = cv2.findChessboardCornersSB(grey, size, flags=flags)
        return np.asarray(pixels, dtype=float).reshape(-1, 2) if found else None

    return detect


def _shrinking(grey: Grey, long_side_px: int) -> tuple[float, float]:
    """The scale that brings the longer side down to so many pixels; never above one."""
    scale = min(1.0, long_side_px / max(grey.shape))
    return scale, scale


def _resized(grey: Grey, scale: tuple[float, float]) -> UInt8[Array, "_ _"]:
    if scale == (1, 1):
        return grey
    method = cv2.INTER_AREA if max(scale) <= 1 else cv2.INTER_CUBIC
    return cv2.resize(grey, None, fx=scale[0], fy=scale[1], interpolation=method)


def _original(pixels: Float[Array, "n 2"], small: UInt8[Array, "_ _"], grey: Grey) -> Float[Array, "n 2"]:
    """Pixels of a resized picture as pixels of the one it came from."""
    ratio = np.array([grey.shape[1] / small.shape[1], grey.shape[0] / small.shape[0]])
    return (pixels + 0.5) * ratio - 0.5


def _refitted(grid: Grid, size: Size) -> Float[Array, "n 2"]:
    """The grid's corners so that they read as (rows, columns), row by row."""
    columns, rows = size
    return (grid if grid.shape[:2] == (rows, columns) else grid.transpose(1, 0, 2)).reshape(-1, 2)


def _stretched(grey: Grey) -> Grey:
    low, high = np.percentile(grey, (1, 99))
    scale = 255 / max(high - low, 1)
    return np.clip((grey - low) * scale, 0, 255).astype(np.uint8)


def _levelled(grey: Grey) -> Grey:
    """Brightness against its surroundings, in their own spread: shadows lose their edges."""
    reach = max(grey.shape) / 50
    light = np.log(grey.astype(np.float32) + 4)
    light -= cv2.GaussianBlur(light, (0, 0), reach)
    spread = np.sqrt(cv2.GaussianBlur(light * light, (0, 0), reach)) + 0.02
    return np.clip(128 + 60 * light / spread, 0, 255).astype(np.uint8)


def refined_by_gradients(grey: Grey, pixels: Float[Array, "n 2"], size: Size) -> Float[Array, "n 2"]:
    """OpenCV's cornerSubPix with a window that stays inside the squares around each corner.

    One window for the board would overrun the far squares of a tilted board: corners are refined in
    groups of equal window, 0.35 of the distance to the nearest neighbour.
    """
    columns, rows = size
    half = np.clip(0.35 * spacing(pixels.reshape(rows, columns, 2)).ravel(), 2, 11).astype(int)
    refined = pixels.astype(np.float32)
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 40, 0.005)
    for window in np.unique(half):
        group = half == window
        start = refined[group].reshape(-1, 1, 2).copy()
        refined[group] = cv2.cornerSubPix(grey, start, (int(window),) * 2, (-1, -1), stop).reshape(-1, 2)
    # A corner that wandered off found something else.
    wandered = np.linalg.norm(refined - pixels, axis=1) > half
    return np.where(wandered[:, None], pixels, refined.astype(float))


def spacing(grid: Float[Array, "rows columns 2"]) -> Float[Array, "rows columns"]:
    """Distance of each corner to its nearest neighbour on the grid [px]."""
    across = np.linalg.norm(np.diff(grid, axis=1), axis=2)
    down = np.linalg.norm(np.diff(grid, axis=0), axis=2)
    near = np.full(grid.shape[:2], np.inf)
    near[:, 1:] = np.minimum(near[:, 1:], across)
    near[:, :-1] = np.minimum(near[:, :-1], across)
    near[1:] = np.minimum(near[1:], down)
    near[:-1] = np.minimum(near[:-1], down)
    return near
