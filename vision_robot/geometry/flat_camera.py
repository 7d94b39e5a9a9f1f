"""The pinhole camera of an undistorted picture: which part of the lens' field it shows."""

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry.camera import Camera
from vision_robot.types import Array, Float

__all__ = ["KEEP", "flat_camera"]

KEEP = ("same", "all", "valid")
"""same: under the same K; all: every pixel of the source; valid: as much as leaves no empty pixel."""

BORDER = 400
WIDEST = np.tan(np.radians(80))
"""A flat picture of more than 160 degrees would be all border."""
SHRINK = 0.998


def flat_camera(source: Camera, keep: str = "valid") -> Camera:
    """A camera without distortion and of the same size, for pictures of `source` made flat.

    Square it is not: fx to fy stays as it was, skew becomes zero. Raises BadParameter for an unknown
    `keep`, and where a flat picture cannot hold the field: a lens that sees too wide.
    """
    if keep not in KEEP:
        raise BadParameter("keep", keep, f"one of {', '.join(KEEP)}")
    if keep == "same":
        return source.without_distortion()
    left, top, right, bottom = _border(source)
    if keep == "all":
        low = np.array([left[:, 0].min(), top[:, 1].min()])
        high = np.array([right[:, 0].max(), bottom[:, 1].max()])
        if not np.isfinite([low, high]).all() or np.abs([low, high]).max() > WIDEST:
            allowed = "a lens of less than 160 degrees: a flat picture cannot hold all of this one"
            raise BadParameter("keep", keep, f"valid, or {allowed}")
        return _framing(source, low, high, largest=False)
    # Where the outline lies past the side of the lens, it does not limit the box.
    low = np.array([side.max(initial=-WIDEST, where=np.isfinite(side)) for side in (left[:, 0], top[:, 1])])
    high = np.array(
        [side.min(initial=WIDEST, where=np.isfinite(side)) for side in (right[:, 0], bottom[:, 1])]
    )
    if (low >= high).any():
        raise BadParameter("keep", keep, "same, or a lens that sees its whole picture")
    # The corners of the largest box inside the field may stick out of a lens that is not round.
    for _ in range(2000):
        camera = _framing(source, low, high, largest=True)
        if _filled(source, camera):
            return camera
        middle = (low + high) / 2
        low, high = middle + SHRINK * (low - middle), middle + SHRINK * (high - middle)
    raise BadParameter("keep", keep, "same, or a lens that sees its whole picture")


def _border(camera: Camera) -> tuple[Float[Array, "n 2"], ...]:
    """(x, y) on the flat plane of the picture's outline: left, top, right, bottom."""
    w, h = camera.width - 1.0, camera.height - 1.0
    u, v = np.arange(camera.width, dtype=float), np.arange(camera.height, dtype=float)
    sides = (
        np.stack([0 * v, v], axis=1),
        np.stack([u, 0 * u], axis=1),
        np.stack([0 * v + w, v], axis=1),
        np.stack([u, 0 * u + h], axis=1),
    )
    flat = []
    for side in sides:
        rays = camera.unproject(side)
        with np.errstate(invalid="ignore", divide="ignore"):
            flat.append(np.where(rays[:, 2:] > 0, rays[:, :2] / rays[:, 2:], np.nan))
    return tuple(flat)


def _framing(source: Camera, low: Float[Array, "2"], high: Float[Array, "2"], *, largest: bool) -> Camera:
    """The camera whose picture holds the box, or lies inside it where `largest`; the middles coincide."""
    size = np.array([source.width, source.height], dtype=float)
    aspect = np.array([1.0, source.fy / source.fx])
    scales = (size - 1) / (aspect * (high - low))
    fx, fy = float(scales.max() if largest else scales.min()) * aspect
    cx, cy = (size - 1) / 2 - np.array([fx, fy]) * (low + high) / 2
    return Camera(source.width, source.height, float(fx), float(fy), float(cx), float(cy))


def _filled(source: Camera, camera: Camera) -> bool:
    """Whether every pixel on the outline of `camera` is one of `source`'s."""
    w, h = camera.width - 1.0, camera.height - 1.0
    s = np.linspace(0, 1, BORDER)
    outline = np.concatenate(
        [
            np.stack([w * a, h * b], axis=1)
            for a, b in ((s, 0 * s), (s, 0 * s + 1), (0 * s, s), (0 * s + 1, s))
        ]
    )
    pixels = source.project(camera.unproject(outline))
    with np.errstate(invalid="ignore"):
        inside = (pixels >= 0) & (pixels <= [source.width - 1, source.height - 1])
    return bool(inside.all())
