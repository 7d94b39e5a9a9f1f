"""Pinhole pictures which together cover the field of a distorted camera."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import cv2
import numpy as np

from vision_robot.geometry import SE3, Camera, pixel_grid
from vision_robot.types import Array, Bool, Float, Image, Int, Integer, UInt8

__all__ = ["PinholeCover"]

DENSITY = 1.5
"""Pixels of the pinhole pictures per pixel of the camera, where they are coarsest.

With 2x2 samples per pixel the corners found on the result are as good as on a straight
render; 1.0 blurs visibly, 2.0 costs twice the time for nothing a detector can see.
"""
SUBSAMPLES = 2
WIDEST_SINGLE = 1.4
"""Largest |x/z| or |y/z| that one picture covers; a wider field is put together from cube faces."""
LARGEST_PICTURE = 8192
STRONGEST = 4
"""Magnification over the lens' focal length up to which `DENSITY` is kept: towards straight
backwards a fisheye magnifies without bound, and there smooth pixels must do."""
MARGIN = 3


@dataclass(frozen=True)
class _Patch:
    """Where one pinhole picture fills the camera's image."""

    face: Camera
    turn: SE3
    """cam_from_face."""
    window: tuple[slice, slice]
    """Rows and columns of the camera's image."""
    inside: Bool[Array, "rows columns"]
    fine: Float[Array, "fine_rows fine_columns 2"]
    """Pixels of `face` at the n x n samples of each pixel, float32 for OpenCV."""
    centres: Float[Array, "rows columns 2"]
    """Pixels of `face` at the pixel centres, float32."""

    @cached_property
    def nearest(self) -> Int[Array, "2 n"]:
        """Column and row in `face` nearest to each pixel centre inside."""
        return np.rint(self.centres[self.inside]).astype(np.intp).T


@dataclass(frozen=True)
class PinholeCover:
    """A camera with a lens (or skew) as resampled pinhole pictures.

    Each pixel is the mean of `SUBSAMPLES` x `SUBSAMPLES` bilinear samples, so it gathers
    light from its own area also where the lens squeezes the field together. (OpenCV's
    bicubic and Lanczos kernels do not reproduce a straight slope and shift single samples
    by up to 0.05 px; the bilinear one does not.)
    """

    camera: Camera
    patches: tuple[_Patch, ...]
    rays: Float[Array, "height width 3"]

    @classmethod
    def of(cls, camera: Camera) -> Self:
        """Choose the pictures and compute the maps."""
        # One pixel more on every side, so that samples of border pixels are interpolated too.
        grid = pixel_grid(camera.width + 2, camera.height + 2) - 1
        rays = camera.unproject(grid)
        sides, turns = _faces(rays)
        focal_limit = STRONGEST * DENSITY * max(camera.fx, camera.fy)
        patches = [_patch(rays, sides == i, turn, focal_limit) for i, turn in enumerate(turns)]
        return cls(camera, tuple(p for p in patches if p is not None), rays[1:-1, 1:-1])

    @property
    def faces(self) -> list[tuple[Camera, SE3]]:
        """The pinhole pictures to render, each with its cam_from_face."""
        return [(patch.face, patch.turn) for patch in self.patches]

    def assemble(self, pictures: Sequence[UInt8[Array, "_ _ *channels"]]) -> Image:
        """The camera's image from the pictures of `faces`; black where the lens sees nothing."""
        n, channels = SUBSAMPLES, pictures[0].shape[2:]
        image = np.zeros((self.camera.height, self.camera.width, *channels), dtype=np.uint8)
        for patch, picture in zip(self.patches, pictures, strict=True):
            fine = _resample(picture, patch.fine, cv2.INTER_LINEAR)
            size = (fine.shape[1] // n, fine.shape[0] // n)
            values = cv2.resize(fine, size, interpolation=cv2.INTER_AREA)
            np.copyto(image[patch.window], values, where=_like(patch.inside, values))
        return image

    def assemble_depth(
        self,
        depths: Sequence[Float[Array, "_ _"]],
        numbers: Sequence[Integer[Array, "_ _"]],
    ) -> Float[Array, "height width"]:
        """Depth [m] along the camera's axis from the depths and the numbers of what is seen in `faces`."""
        depth = np.full(self.rays.shape[:2], np.nan, dtype=np.float32)
        for patch, picture, number in zip(self.patches, depths, numbers, strict=True):
            with np.errstate(divide="ignore"):
                inverse = (1 / picture).astype(np.float32)  # linear in the pixel on every plane
            value = _resample(inverse, patch.centres, cv2.INTER_LINEAR)
            nearest = _resample(inverse, patch.centres, cv2.INTER_NEAREST)
            # No mixing of near and far, neither across the outline of a body nor where it hides itself.
            mixed = _resample(_uneven(number), patch.centres - 0.5, cv2.INTER_NEAREST) > 0
            mixed = (mixed | (np.abs(value - nearest) > 0.01 * nearest)) & patch.inside
            value[mixed] = _one_sided(inverse, number, patch.centres[mixed])
            rays = self.rays[patch.window]
            along_face = rays @ patch.turn.rotation[:, 2]
            with np.errstate(divide="ignore", invalid="ignore"):
                metres = rays[..., 2] / (along_face * value)
            np.copyto(depth[patch.window], metres, where=patch.inside)
        return depth

    def assemble_numbers(self, numbers: Sequence[Integer[Array, "_ _"]]) -> Integer[Array, "height width"]:
        """Numbers of what is seen from those of `faces`, each of the nearest pixel; 0 outside the lens."""
        result = np.zeros(self.rays.shape[:2], dtype=numbers[0].dtype)
        for patch, picture in zip(self.patches, numbers, strict=True):
            u, v = patch.nearest
            result[patch.window][patch.inside] = picture[v, u]
        return result


def _uneven(number: Integer[Array, "rows columns"]) -> UInt8[Array, "rows columns"]:
    """Where a pixel's number is not that of its neighbours to the right, below, and both."""
    uneven = np.zeros(number.shape, dtype=np.uint8)
    one = number[:-1, :-1]
    uneven[:-1, :-1] = (one != number[:-1, 1:]) | (one != number[1:, :-1]) | (one != number[1:, 1:])
    return uneven


def _one_sided(
    inverse: Float[Array, "rows columns"], number: Integer[Array, "rows columns"], pixels: Float[Array, "n 2"]
) -> Float[Array, "n"]:
    """Inverse depth at pixels, continued from the nearest one along the body that is seen there."""
    rows, columns = inverse.shape
    u, v = np.rint(pixels).astype(np.intp).T
    u, v = np.clip(u, 1, columns - 2), np.clip(v, 1, rows - 2)
    value, mine = inverse[v, u], number[v, u]
    result = value.copy()
    for (du, dv), offset in (((1, 0), pixels[:, 0] - u), ((0, 1), pixels[:, 1] - v)):
        slopes = []
        for sign in (1, -1):
            there = v + sign * dv, u + sign * du
            slopes.append(np.where(number[there] == mine, sign * (inverse[there] - value), np.inf))
        # Where both neighbours belong to the body, the smaller slope is the one that does not jump.
        slope = np.where(np.abs(slopes[0]) <= np.abs(slopes[1]), slopes[0], slopes[1])
        result += np.where(np.isfinite(slope), slope, 0) * offset
    return result


def _resample(picture: Array, pixels: Float[Array, "rows columns 2"], kernel: int) -> Array:
    # One map holds both coordinates; OpenCV's type stubs do not know that the second may be None.
    return cv2.remap(picture, pixels, None, kernel)  # pyright: ignore[reportCallIssue, reportArgumentType]


def _like(mask: Array, values: Array) -> Array:
    return mask if values.ndim == mask.ndim else mask[..., None]


def _faces(rays: Float[Array, "rows columns 3"]) -> tuple[Integer[Array, "rows columns"], list[SE3]]:
    """Which face each ray falls on (-1 where there is no ray), and cam_from_face of the faces."""
    seen = np.isfinite(rays[..., 2])
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.abs(rays[..., :2]).max(axis=-1) / rays[..., 2]
    if not seen.any() or ((rays[..., 2] > 0) & (slope < WIDEST_SINGLE))[seen].all():
        return np.where(seen, 0, -1), [SE3.identity()]
    quarter = np.pi / 2
    # Ahead, right, left, down, up, back.
    turns = [(0, 0), (0, quarter), (0, -quarter), (-quarter, 0), (quarter, 0), (0, np.pi)]
    faces = [SE3.from_rotvec(np.array([a, b, 0.0]), np.zeros(3)) for a, b in turns]
    along = np.stack([rays @ face.rotation[:, 2] for face in faces])
    return np.where(seen, np.argmax(np.nan_to_num(along, nan=-2), axis=0), -1), faces


def _patch(
    rays: Float[Array, "rows columns 3"], mine: Bool[Array, "rows columns"], turn: SE3, focal_limit: float
) -> _Patch | None:
    """The part of the image that one face fills; `rays` and `mine` are padded by one pixel."""
    if not mine[1:-1, 1:-1].any():
        return None
    rows, columns = np.flatnonzero(mine.any(axis=1)), np.flatnonzero(mine.any(axis=0))
    top, bottom = max(rows[0], 1), min(rows[-1], mine.shape[0] - 2) + 1
    left, right = max(columns[0], 1), min(columns[-1], mine.shape[1] - 2) + 1
    padded = (slice(top - 1, bottom + 1), slice(left - 1, right + 1))
    mine, ray = mine[padded], rays[padded] @ turn.rotation
    with np.errstate(divide="ignore", invalid="ignore"):
        plane = np.where(ray[..., 2:] > 0.05, ray[..., :2] / ray[..., 2:], np.nan)
    face = _face_camera(plane, mine, focal_limit)
    pixels = (plane * (face.fx, face.fy) + (face.cx, face.cy)).astype(np.float32)
    n = SUBSAMPLES
    size = (pixels.shape[1] * n, pixels.shape[0] * n)
    fine = cv2.resize(pixels, size, interpolation=cv2.INTER_LINEAR)[n:-n, n:-n]
    return _Patch(
        face=face,
        turn=turn,
        window=(slice(top - 1, bottom - 1), slice(left - 1, right - 1)),
        inside=mine[1:-1, 1:-1],
        fine=np.ascontiguousarray(np.nan_to_num(fine, nan=-9.0)),
        centres=np.ascontiguousarray(np.nan_to_num(pixels[1:-1, 1:-1], nan=-9.0)),
    )


def _face_camera(
    plane: Float[Array, "rows columns 2"], mine: Bool[Array, "rows columns"], focal_limit: float
) -> Camera:
    """A pinhole that holds the points `mine` of the plane z = 1 at `DENSITY`."""
    # The samples of a pixel reach half-way to its neighbours.
    held = np.where(cv2.dilate(mine.astype(np.uint8), np.ones((3, 3)))[..., None] > 0, plane, np.nan)
    low, high = np.nanmin(held, axis=(0, 1)), np.nanmax(held, axis=(0, 1))
    along_u, along_v = np.diff(held, axis=1)[:-1], np.diff(held, axis=0)[:, :-1]
    step = np.hypot(along_u, along_v)
    # A field of a pixel or two has no differences to go by.
    finest = np.nanmin(step, axis=(0, 1)) if np.isfinite(step).any() else np.ones(2)
    focal = np.minimum(DENSITY / finest, focal_limit)
    focal = np.minimum(focal, (LARGEST_PICTURE - 2 * MARGIN - 1) / np.maximum(high - low, 1e-9))
    origin = MARGIN - focal * low
    size = np.ceil(focal * (high - low)).astype(int) + 2 * MARGIN + 1
    (width, height), (fx, fy), (cx, cy) = size.tolist(), focal.tolist(), origin.tolist()
    return Camera(width, height, fx, fy, cx, cy)
