"""The bead's centre in drawn pictures: shaded, before a two-coloured ground, half hidden by its shaft."""

import cv2
import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.extrinsics.bead import COLOURS, find_bead

FINE = 16


def drawn(centre: tuple[float, float], radius: float, *, shaft: bool, noise: float = 1.0) -> np.ndarray:
    """A red ball lit from one side, drawn sixteen times finer and averaged down."""
    h, w = 96, 128
    v, u = np.mgrid[: h * FINE, : w * FINE]
    u, v = (u + 0.5) / FINE - 0.5, (v + 0.5) / FINE - 0.5
    image = np.where(u[..., None] < centre[0], [150.0, 150, 150], [40.0, 40, 40])
    x, y = (u - centre[0]) / radius, (v - centre[1]) / radius
    inside = x * x + y * y < 1
    depth = np.sqrt(np.clip(1 - x * x - y * y, 0, 1))
    light = (0.5 + 0.4 * np.clip(0.4 * x - 0.3 * y + 0.8 * depth, 0, 1))[..., None]
    image = np.where(inside[..., None], light * np.array([30.0, 30, 240]), image)
    if shaft:
        image = np.where(((np.abs(x) < 0.4) & (y < -0.6))[..., None], [70.0, 65, 65], image)
    small = image.reshape(h, FINE, w, FINE, 3).mean(axis=(1, 3))
    small += np.random.default_rng(0).normal(size=small.shape) * noise
    return np.clip(np.rint(small), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("shaft", [False, True])
@pytest.mark.parametrize("centre", [(61.3, 47.7), (60.0, 48.5)])
@pytest.mark.parametrize("radius", [6.0, 11.0])
def test_the_centre_is_found(shaft, centre, radius):
    found = find_bead(drawn(centre, radius, shaft=shaft), COLOURS["red"])
    assert found is not None
    assert np.abs(found[0] - centre).max() < (0.12 if shaft else 0.06)
    assert 0.01 <= found[1] < 0.2


def test_no_bead_no_answer():
    grey = np.full((96, 128, 3), 120, np.uint8)
    assert find_bead(grey, COLOURS["red"]) is None
    picture = drawn((61, 47), 8.0, shaft=False)
    assert find_bead(picture, COLOURS["green"]) is None
    assert find_bead(picture[:, :61], COLOURS["red"]) is None  # cut off by the border
    with pytest.raises(BadParameter, match="in colour"):
        find_bead(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), COLOURS["red"])
    with pytest.raises(BadParameter, match="not grey"):
        find_bead(picture, (128, 128, 128))
