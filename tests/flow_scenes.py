"""Picture pairs whose flow is known exactly: textured layers that move by affine maps, sampled by area."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

FINE = 4
"""Samples per pixel and axis."""


Outline = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Layer:
    """A texture, where it is, and how it moves from the first picture to the second.

    `texture` is a grey picture whose pixel (0, 0) lies on pixel `corner` of the first picture; it goes on
    beyond its border as in a mirror. `outline` says where the layer is, from pixel coordinates of the first
    picture to booleans; none is everywhere. `motion` is 2×3 and takes pixels of the first picture to the
    second.
    """

    texture: np.ndarray
    motion: np.ndarray
    outline: Outline | None = None
    corner: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Pair:
    """Two pictures, the flow from the first to the second (height, width, 2) [px], and what stays visible."""

    first: np.ndarray
    second: np.ndarray
    flow: np.ndarray
    visible: np.ndarray


def rendered(
    layers: list[Layer], size: tuple[int, int], *, noise: float = 0.0, gain: float = 1.0, seed: int = 0
) -> Pair:
    """The layers, from back to front, before and after their motion; `gain` multiplies the second picture."""
    rng = np.random.default_rng(seed)
    identity = np.array([[1, 0, 0], [0, 1, 0]], dtype=float)
    first, owner = _view(layers, size, [identity] * len(layers))
    second, _ = _view(layers, size, [layer.motion for layer in layers])
    u, v = np.meshgrid(np.arange(size[0], dtype=float), np.arange(size[1], dtype=float))
    end_u, end_v = np.empty_like(u), np.empty_like(v)
    for k, layer in enumerate(layers):
        x, y = _moved(layer.motion, u, v)
        end_u, end_v = np.where(owner == k, x, end_u), np.where(owner == k, y, end_v)
    inside = (end_u >= 0) & (end_u <= size[0] - 1) & (end_v >= 0) & (end_v <= size[1] - 1)
    visible = inside & (_owner(layers, end_u, end_v, [layer.motion for layer in layers]) == owner)
    before, after = (
        np.clip(np.rint(scale * picture + noise * rng.normal(size=picture.shape)), 0, 255).astype(np.uint8)
        for picture, scale in ((first, 1.0), (second, gain))
    )
    return Pair(before, after, np.stack([end_u - u, end_v - v], axis=-1), visible)


def affine(
    shift: tuple[float, float],
    *,
    turn_deg: float = 0.0,
    zoom: float = 1.0,
    about: tuple[float, float] = (0, 0),
) -> np.ndarray:
    """Turn and zoom about a pixel, then shift [px]."""
    angle = np.deg2rad(turn_deg)
    matrix = zoom * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    centre = np.asarray(about, dtype=float)
    return np.column_stack([matrix, centre - matrix @ centre + shift])


def noise_texture(
    size: tuple[int, int], *, seed: int, finest_px: float = 2.0, contrast: float = 40.0
) -> np.ndarray:
    """Random grey of all scales down to `finest_px`, each half as strong as the one twice as large."""
    rng = np.random.default_rng(seed)
    total, strength, scale = np.zeros(size[::-1]), 1.0, 64.0
    while scale >= finest_px:
        coarse = rng.normal(size=(int(size[1] / scale) + 3, int(size[0] / scale) + 3)).astype(np.float32)
        total += strength * cv2.resize(coarse, size, interpolation=cv2.INTER_CUBIC)
        strength, scale = strength * 0.6, scale / 2
    return (128 + contrast * total / total.std()).clip(0, 255).astype(np.float32)


def ellipse(centre: tuple[float, float], axes: tuple[float, float], turn_deg: float = 0.0) -> Outline:
    """Outline of an ellipse with these half axes [px]."""
    c, s = np.cos(np.deg2rad(turn_deg)), np.sin(np.deg2rad(turn_deg))

    def inside(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        a, b = u - centre[0], v - centre[1]
        return ((c * a + s * b) / axes[0]) ** 2 + ((c * b - s * a) / axes[1]) ** 2 <= 1

    return inside


def rod(centre: tuple[float, float], length: float, width: float, turn_deg: float = 0.0) -> Outline:
    """Outline of a rectangle."""
    c, s = np.cos(np.deg2rad(turn_deg)), np.sin(np.deg2rad(turn_deg))

    def inside(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        a, b = u - centre[0], v - centre[1]
        return (abs(c * a + s * b) <= length / 2) & (abs(c * b - s * a) <= width / 2)

    return inside


def _view(
    layers: list[Layer], size: tuple[int, int], motions: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """The picture, and which layer each pixel's centre shows."""
    width, height = size
    fine_u = (np.arange(width * FINE) + 0.5) / FINE - 0.5
    fine_v = (np.arange(height * FINE) + 0.5) / FINE - 0.5
    u, v = np.meshgrid(fine_u, fine_v)
    picture = np.zeros(u.shape, np.float32)
    for layer, motion in zip(layers, motions, strict=True):
        x, y = _moved(_inverse(motion), u, v)
        grey = cv2.remap(
            layer.texture.astype(np.float32),
            (x - layer.corner[0]).astype(np.float32),
            (y - layer.corner[1]).astype(np.float32),
            cv2.INTER_CUBIC,
            borderMode=cv2.BORDER_REFLECT,
        )
        picture = grey if layer.outline is None else np.where(layer.outline(x, y), grey, picture)
    mean = picture.reshape(height, FINE, width, FINE).mean(axis=(1, 3))
    whole_u, whole_v = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    return mean, _owner(layers, whole_u, whole_v, motions)


def _owner(layers: list[Layer], u: np.ndarray, v: np.ndarray, motions: list[np.ndarray]) -> np.ndarray:
    owner = np.zeros(u.shape, int)
    for k, (layer, motion) in enumerate(zip(layers, motions, strict=True)):
        if layer.outline is not None:
            owner[layer.outline(*_moved(_inverse(motion), u, v))] = k
    return owner


def _moved(motion: np.ndarray, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return (
        motion[0, 0] * u + motion[0, 1] * v + motion[0, 2],
        motion[1, 0] * u + motion[1, 1] * v + motion[1, 2],
    )


def _inverse(motion: np.ndarray) -> np.ndarray:
    matrix = np.linalg.inv(motion[:, :2])
    return np.column_stack([matrix, -matrix @ motion[:, 2]])
