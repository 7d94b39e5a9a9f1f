"""Finding the markers of a coded board: a cascade of thresholds, then a check against the board.

One pass of OpenCV's detector misses markers in blur, noise, glare and at small scale; what several
passes find is put together, and a marker counts only if its neighbours lie where the board has them.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.types import Array, Bool, Float, Int, UInt8

__all__ = ["Markers", "find_markers", "local_pixels"]

Grey = UInt8[Array, "height width"]

LARGE_PX, SMALL_PX = 2400, 900
"""Longer pictures are shrunk first; shorter ones are also tried magnified."""

SMALLEST_PERIMETER_PX = 48

NEIGHBOURS = 8


@dataclass(frozen=True)
class Markers:
    """Markers seen: `ids` (n,) and the `pixels` (n, 4, 2) of their corners in the dictionary's order."""

    ids: Int[Array, "n"]
    pixels: Float[Array, "n 4 2"]

    def __len__(self) -> int:
        return len(self.ids)


def find_markers(
    grey: Grey,
    dictionary: cv2.aruco.Dictionary,
    corners_in_board: Float[Array, "m 4 2"],
    *,
    border_bits: int = 1,
) -> Markers:
    """The board's markers in a picture; `corners_in_board` [m] has one row for each id.

    Markers that do not fit their neighbours are dropped; a lone marker proves no board and is dropped too.
    None is returned when most do not fit: the picture shows another board of the same dictionary, on
    which some rows may agree.
    """
    seen: dict[int, Array] = {}
    misfits: set[int] = set()
    kept = Markers(np.zeros(0, dtype=int), np.zeros((0, 4, 2)))
    for attempt, (picture, threshold) in enumerate(_attempts(grey)):
        for marker, pixels in _detect(picture, dictionary, border_bits, threshold, grey.shape):
            if marker < len(corners_in_board):
                seen.setdefault(marker, pixels)
        before, kept = len(kept), _consistent(seen, corners_in_board)
        fitting = set(kept.ids.tolist())
        misfits = (misfits | set(seen)) - fitting
        if fitting:
            seen = {marker: pixels for marker, pixels in seen.items() if marker in fitting}
        # A few missing markers do no harm: their corners are found from their neighbours.
        complete = len(kept) == len(corners_in_board)
        if complete or (attempt >= 1 and 0 < len(kept) <= 1.1 * before):
            break
    return kept if len(kept) > len(misfits) else Markers(kept.ids[:0], kept.pixels[:0])


def local_pixels(
    markers: Markers, corners_in_board: Float[Array, "m 4 2"], points: Float[Array, "n k 2"]
) -> tuple[Float[Array, "n k 2"], Float[Array, "n"]]:
    """Pixels of groups of board positions [m] by the homography of the two markers nearest to each group.

    Also the distance of a group's first position from the nearest marker's centre, in sides of a marker:
    beyond about one the pixels are a guess.
    """
    board = corners_in_board[markers.ids]
    centres = board.mean(axis=1)
    side = float(np.linalg.norm(board[0, 1] - board[0, 0]))
    pixels, reach = np.empty(points.shape), np.empty(len(points))
    for k, group in enumerate(points):
        distance = np.linalg.norm(centres - group[0], axis=1)
        near = np.argsort(distance, kind="stable")[:2]
        near = near[distance[near] < distance[near[0]] + side]
        pixels[k] = _mapped(board[near].reshape(-1, 2), markers.pixels[near].reshape(-1, 2), group)
        reach[k] = distance[near[0]] / side
    return pixels, reach


def _attempts(grey: Grey) -> Iterator[tuple[Grey, float]]:
    """Pictures derived from the photo, and how much darker than its surroundings black must be."""
    long_side = max(grey.shape)
    if long_side > LARGE_PX:
        grey = cv2.resize(
            grey, None, fx=LARGE_PX / long_side, fy=LARGE_PX / long_side, interpolation=cv2.INTER_AREA
        )
    # Black that touches black at a corner is cut apart by a high threshold, thin black kept by a low one.
    yield grey, 15
    yield grey, 7
    low, high = np.percentile(grey, (1, 99))
    stretched = np.clip((grey - low) * (255 / max(high - low, 1)), 0, 255).astype(np.uint8)
    yield cv2.createCLAHE(clipLimit=4.0, tileGridSize=(8, 8)).apply(stretched), 15
    smooth = cv2.GaussianBlur(stretched, (0, 0), 1.5)
    yield smooth, 5
    yield smooth, 20
    if long_side <= 2 * SMALL_PX:
        yield cv2.resize(stretched, None, fx=2, fy=2, interpolation=cv2.INTER_CUBIC), 10
    if long_side > SMALL_PX:
        yield cv2.resize(stretched, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA), 7
    sharpened = cv2.addWeighted(stretched, 2.5, cv2.GaussianBlur(stretched, (0, 0), 3), -1.5, 0)
    yield sharpened, 15


def _detect(
    picture: Grey,
    dictionary: cv2.aruco.Dictionary,
    border_bits: int,
    threshold: float,
    shape: tuple[int, ...],
) -> Iterator[tuple[int, Float[Array, "4 2"]]]:
    settings = cv2.aruco.DetectorParameters()
    settings.markerBorderBits = border_bits
    settings.adaptiveThreshConstant = threshold
    long_side = max(picture.shape)
    settings.adaptiveThreshWinSizeMin = 5
    settings.adaptiveThreshWinSizeMax = max(23, long_side // 20)
    settings.adaptiveThreshWinSizeStep = max(10, (settings.adaptiveThreshWinSizeMax - 5) // 3)
    settings.minMarkerPerimeterRate = SMALLEST_PERIMETER_PX / long_side
    settings.minCornerDistanceRate = 0.03
    settings.polygonalApproxAccuracyRate = 0.05
    settings.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_CONTOUR
    corners, ids, _ = cv2.aruco.ArucoDetector(dictionary, settings).detectMarkers(picture)
    ratio = np.array([shape[1] / picture.shape[1], shape[0] / picture.shape[0]])
    found = [] if ids is None else [int(marker) for marker in np.asarray(ids).ravel()]
    for marker, pixels in zip(found, corners, strict=True):
        if found.count(marker) == 1:
            yield marker, (np.asarray(pixels, dtype=float).reshape(4, 2) + 0.5) * ratio - 0.5


def _consistent(seen: dict[int, Array], corners_in_board: Float[Array, "m 4 2"]) -> Markers:
    """Markers from which at least half of their nearest neighbours are seen where they should be."""
    ids = np.array(sorted(seen), dtype=int)
    pixels = np.array([seen[i] for i in ids]).reshape(-1, 4, 2)
    while len(ids) > 1:
        fits = _fits(ids, pixels, corners_in_board)
        if fits.min() >= 0.5:
            return Markers(ids, pixels)
        keep = fits > fits.min()
        ids, pixels = ids[keep], pixels[keep]
    return Markers(ids[:0], pixels[:0])


def _fits(
    ids: Int[Array, "n"], pixels: Float[Array, "n 4 2"], corners_in_board: Float[Array, "m 4 2"]
) -> Float[Array, "n"]:
    """Share of each marker's nearest neighbours that agree with it."""
    board = corners_in_board[ids]
    centres, seen = board.mean(axis=1), pixels.mean(axis=1)
    agreement = np.zeros(len(ids))
    agrees = np.zeros((len(ids), len(ids)), dtype=bool)
    nearest = np.argsort(np.linalg.norm(centres[:, None] - centres, axis=2), axis=1, kind="stable")
    nearest = nearest[:, 1 : 1 + NEIGHBOURS]
    for k, others in enumerate(nearest):
        agrees[k, others] = _agree(board[k], pixels[k], centres[others], seen[others])
    for k, others in enumerate(nearest):
        agreement[k] = agrees[k, others].mean()
    return agreement


def _agree(
    board: Float[Array, "4 2"],
    pixels: Float[Array, "4 2"],
    others: Float[Array, "n 2"],
    seen: Float[Array, "n 2"],
) -> Bool[Array, "n"]:
    # A marker's own homography is trusted for a quarter of the distance to a neighbour: its corners
    # are known to a pixel or so, and lenses bend.
    expected = _mapped(board, pixels, others)
    distance = np.linalg.norm(expected - pixels.mean(axis=0), axis=1)
    return np.linalg.norm(expected - seen, axis=1) < 0.25 * distance


def _mapped(
    source: Float[Array, "k 2"], target: Float[Array, "k 2"], points: Float[Array, "n 2"]
) -> Float[Array, "n 2"]:
    """Points under the homography that carries `source` to `target`; NaN where there is none."""
    H, _ = cv2.findHomography(source, target)
    if H is None:
        return np.full_like(points, np.nan)
    image = np.column_stack([points, np.ones(len(points))]) @ H.T
    return image[:, :2] / image[:, 2:]
