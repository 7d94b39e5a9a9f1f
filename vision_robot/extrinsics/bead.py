"""A bead of one colour on a tool's tip: where its centre is in a picture, to a small part of a pixel."""

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float, Image

__all__ = ["COLOURS", "find_bead"]

COLOURS = {
    "red": (255, 0, 0),
    "green": (0, 255, 0),
    "blue": (0, 0, 255),
    "yellow": (255, 255, 0),
    "magenta": (255, 0, 255),
    "cyan": (0, 255, 255),
    "orange": (255, 128, 0),
}
"""Red, green, blue of colours by name."""

LIKENESS = 0.5
"""Share of the bead's own saturation from which a pixel belongs to it."""
FEWEST_PX = 9.0
"""A bead whose outline is shorter [px] is not told from noise."""


def find_bead(image: Image, rgb: tuple[int, int, int]) -> tuple[Float[Array, "2"], float] | None:
    """Centre (u, v) [px] of the largest patch of a colour and its sigma per axis; None where there is none.

    A pixel's likeness is its colour's direction off grey over its brightness, which shading leaves alone;
    the outline is where it is half. Raises BadParameter for a
    grey picture or a grey colour.
    """
    if image.ndim != 3:
        raise BadParameter("picture of the bead", "grey", "in colour")
    wanted = np.array(rgb[::-1], dtype=np.float32)
    off_grey = wanted - wanted.mean()
    if np.linalg.norm(off_grey) < 40:
        raise BadParameter("colour of the bead", rgb, "one that is not grey")
    direction = off_grey / np.linalg.norm(off_grey)
    pixels = cv2.GaussianBlur(image, (3, 3), 0.6).astype(np.float32)
    grey = pixels.mean(axis=2)
    likeness = (pixels @ direction) / (grey + 12.0)
    across = pixels - grey[..., None] - (pixels @ direction)[..., None] * direction
    likeness = np.clip(likeness - np.linalg.norm(across, axis=2) / (grey + 12.0), 0, None)
    full = float(np.quantile(likeness[likeness > 0.4 * likeness.max()], 0.8)) if likeness.any() else 0.0
    if full < 0.25:
        return None
    mask = (likeness > LIKENESS * full).astype(np.uint8)
    count, _, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8)
    if count < 2:
        return None
    best = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    left, top, width, height = stats[best, : cv2.CC_STAT_AREA]
    if left == 0 or top == 0 or left + width == image.shape[1] or top + height == image.shape[0]:
        return None  # cut off by the border: its centre is not where the rest of it is
    middle = np.array([left + (width - 1) / 2, top + (height - 1) / 2])
    # A mixture's own colour is linear in its shares, whatever the brightness of the background.
    colour = (image.astype(np.float32) - image.mean(axis=2, dtype=np.float32)[..., None]) @ direction
    return _circle(colour, middle, max(width, height) / 2)


def _circle(
    colour: Float[Array, "h w"], middle: Float[Array, "2"], radius: float
) -> tuple[Float[Array, "2"], float] | None:
    """The circle through the outline: where rays from the middle leave the bead, most of them agreeing.

    The shaft that holds the bead hides a part of it, so its outline there is no outline: a Cauchy fit leaves
    that part out of account.
    """
    angle = np.linspace(0, 2 * np.pi, RAYS, endpoint=False)
    towards = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    spread, used = 0.0, 0.0
    for _ in range(3):
        reach = np.arange(0.0, 1.5 * radius + 4.0, STEP)
        at = (middle + reach[:, None, None] * towards).astype(np.float32)
        profile = cv2.remap(colour, at[..., 0], at[..., 1], cv2.INTER_LINEAR)
        # Each ray has its own brightness: half way from what is inside, continued to the outline along its
        # shading, to what is outside.
        inner = (reach > 0.45 * radius) & (reach < 0.85 * radius - 0.5)
        outer = (reach > 1.15 * radius + 1) & (reach < 1.35 * radius + 2.5)
        if inner.sum() < 3:
            return None
        slope, level = np.polyfit(reach[inner] - radius, profile[inner], 1)
        light, dark = level, profile[outer].mean(axis=0)
        share = (profile - dark) / np.maximum(light + slope * (reach[:, None] - radius) - dark, 1e-3)
        inside = share >= 0.5
        inside[reach < 0.6 * radius] = True
        out = np.argmin(inside, axis=0)
        known = (out > 0) & (light - dark > 0.3 * np.median(light))
        if known.sum() < RAYS // 2:
            return None
        rays = np.flatnonzero(known)
        high, low = share[out[known] - 1, rays], share[out[known], rays]
        part = np.clip((high - 0.5) / np.maximum(high - low, 1e-6), 0, 1)
        edge = middle + (reach[out[known] - 1] + STEP * part)[:, None] * towards[known]
        found = _robust_circle(edge)
        if found is None:
            return None
        middle, radius, spread, used = found
    if 2 * np.pi * radius < FEWEST_PX:
        return None
    # Neighbouring rays share pixels: as many points count as the outline has pixels.
    independent = min(used, 2 * np.pi * radius)
    return middle, max(float(spread * np.sqrt(2 / max(independent, 1.0))), LEAST_SIGMA_PX)


def _robust_circle(edge: Float[Array, "n 2"]) -> tuple[Float[Array, "2"], float, float, float] | None:
    """Centre, radius, scatter of the outline [px] and how many points carry it."""
    weight = np.ones(len(edge))
    centre, radius, off = edge.mean(axis=0), 0.0, np.zeros(len(edge))
    for k in range(ROUNDS):
        offset = edge - centre
        distance = np.linalg.norm(offset, axis=1)
        A = np.concatenate([-offset / distance[:, None], -np.ones((len(edge), 1))], axis=1)
        radius = float(np.average(distance, weights=weight))
        off = distance - radius
        step = np.linalg.lstsq(A * weight[:, None], -off * weight, rcond=None)[0]
        centre, radius = centre + step[:2], radius + step[2]
        off = np.linalg.norm(edge - centre, axis=1) - radius
        spread = max(float(np.median(np.abs(off))) / 0.6745, 0.02)
        weight = 1 / np.sqrt(1 + (off / (2.4 * spread)) ** 2)
        weight[np.abs(off) > 5 * spread] = 1e-6
        if k >= ROUNDS - 5:
            # What lies beside a hidden part of the outline is half hidden itself.
            hidden = np.abs(off) > 3.5 * spread
            for shift in (-3, -2, -1, 1, 2, 3):
                weight[np.roll(hidden, shift)] = 1e-6
    used = float(np.sum(weight > 0.3))
    if used < len(edge) / 3:
        return None
    return centre, float(radius), float(np.sqrt(np.average(off**2, weights=weight**2))), used


RAYS = 96
ROUNDS = 18
STEP = 0.25
LEAST_SIGMA_PX = 0.03
"""The shading of a light that is not known moves the centre by some hundredths of a pixel."""
