"""From the numbers of a file to a Camera, with the checks all formats share."""

from collections.abc import Sequence

from vision_robot.errors import BadParameter
from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree
from vision_robot.geometry import Camera

__all__ = ["affine_from_matrix", "brown_lens", "make_camera"]

MAX_SIDE = 100_000
"""Longest side of a picture [px]; line-scan cameras and mosaics stay below."""

Affine = tuple[float, float, float, float, float]


def make_camera(
    source: CameraSource,
    size: tuple[int, int] | None,
    affine: Affine,
    model: str,
    coefficients: Sequence[float],
) -> Camera:
    """A Camera from (width, height) of the file, (fx, fy, cx, cy, skew) and a lens.

    Where the file holds no size, the caller's is taken. Raises BadCameraFile where none is
    known, where the two differ, and where a number cannot belong to a camera.
    """
    if size is None and source.size is None:
        raise source.bad("it does not hold the image size: give size=(width, height)")
    if size is not None and source.size is not None and size != tuple(source.size):
        raise source.bad(f"it is for {size[0]}x{size[1]} px, not {source.size[0]}x{source.size[1]} px")
    width, height = size or source.size  # pyright: ignore[reportGeneralTypeIssues, reportOptionalIterable]
    if not (0 < width <= MAX_SIDE and 0 < height <= MAX_SIDE):
        raise source.bad(f"image size is {width}x{height}: 1 to {MAX_SIDE} px expected")
    fx, fy, cx, cy, skew = affine
    try:
        return Camera(width, height, fx, fy, cx, cy, skew, model, tuple(coefficients))
    except BadParameter as error:
        raise source.bad(str(error)) from error


def affine_from_matrix(matrix: Tree) -> Affine:
    """(fx, fy, cx, cy, skew) from the nine numbers of K; its other entries must be 0 0 and 0 0 1."""
    fx, skew, cx, below, fy, cy, *last = matrix.numbers(9)
    if below != 0 or last != [0, 0, 1]:
        raise matrix.bad(f"[fx s cx 0 fy cy 0 0 1] expected, 0 0 0 1 there read {[below, *last]}")
    return fx, fy, cx, cy, skew


def brown_lens(coefficients: Tree) -> tuple[str, tuple[float, ...]]:
    """Lens model and coefficients from OpenCV's vector k1 k2 p1 p2 [k3 [k4 k5 k6 [s1..s4 [tx ty]]]].

    All zero reads as pinhole. Thin prism and tilt have no place in our lenses: refused
    unless they are zero.
    """
    k = coefficients.numbers(0, 4, 5, 8, 12, 14)
    if any(k[8:]):
        raise coefficients.bad("thin-prism or tilted-sensor terms (after k6) are not supported")
    if not any(k):
        return "pinhole", ()
    if len(k) <= 5:
        return "brown5", (*k, *(0.0,) * (5 - len(k)))
    return "brown8", tuple(k[:8])
