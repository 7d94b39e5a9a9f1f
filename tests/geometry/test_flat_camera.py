"""Which part of the field a flat picture keeps, and that flattening is an exact change of camera."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter, MixedImageSizes
from vision_robot.flatten import Flattener
from vision_robot.geometry import Camera, pixel_grid, resampling_map
from vision_robot.geometry.flat_camera import flat_camera

BARREL = Camera(640, 480, 500, 510, 325, 236, 0.4, "brown5", (-0.25, 0.09, 6e-4, -4e-4, -0.01))
PILLOW = Camera(640, 480, 500, 510, 325, 236, 0, "brown5", (0.15, 0.02, 6e-4, -4e-4, 0))
FISHEYE = Camera(640, 480, 260, 260, 322, 238, 0, "fisheye", (-0.02, 0.004, 0, 0))
LENSES = pytest.mark.parametrize("source", [BARREL, PILLOW, FISHEYE], ids=["barrel", "pillow", "fisheye"])


@LENSES
def test_valid_leaves_no_empty_pixel_and_little_out(source):
    flat = flat_camera(source, "valid")
    pixels = resampling_map(source, flat)
    assert np.isfinite(pixels).all()
    assert pixels.min() > -1e-9
    assert (pixels.reshape(-1, 2).max(axis=0) < [639 + 1e-9, 479 + 1e-9]).all()
    # One of the sides is reached: nothing larger would do.
    gap = np.concatenate([pixels.reshape(-1, 2).min(axis=0), [639, 479] - pixels.reshape(-1, 2).max(axis=0)])
    assert gap.min() < 2


@pytest.mark.parametrize("source", [BARREL, PILLOW], ids=["barrel", "pillow"])
def test_all_holds_every_pixel(source):
    flat = flat_camera(source, "all")
    pixels = flat.project(source.unproject(pixel_grid(640, 480).reshape(-1, 2)))
    assert pixels.min() > -1e-6
    assert (pixels.max(axis=0) < [639 + 1e-6, 479 + 1e-6]).all()
    spread = np.ptp(pixels, axis=0) / [639, 479]
    assert spread.max() == pytest.approx(1, abs=1e-3)


def test_same_keeps_k():
    assert flat_camera(BARREL, "same") == Camera(640, 480, 500, 510, 325, 236, 0.4)


@pytest.mark.parametrize("keep", ["all", "valid"])
def test_without_distortion_there_is_nothing_to_do(keep):
    plain = Camera(640, 480, 500, 510, 325, 236)
    assert flat_camera(plain, keep).parameters == pytest.approx(plain.parameters, rel=1e-9)


def test_a_flat_picture_cannot_hold_a_hemisphere():
    wide = Camera(640, 480, 180, 180, 319.5, 239.5, 0, "fisheye", (0.0, 0, 0, 0))
    with pytest.raises(BadParameter, match="of less than 160 degrees"):
        flat_camera(wide, "all")
    assert flat_camera(wide, "valid").fx > 0
    with pytest.raises(BadParameter, match="one of same, all, valid"):
        flat_camera(BARREL, "most")


@LENSES
@pytest.mark.parametrize("keep", ["valid", "same"])
def test_a_pixel_goes_there_and_back_exactly(source, keep):
    flat = flat_camera(source, keep)
    pixels = pixel_grid(640, 480)[30:-30:60, 30:-30:60].reshape(-1, 2)
    there = source.project(flat.unproject(pixels))
    back = flat.project(source.unproject(there))
    met = np.isfinite(there[:, 0])
    assert met.sum() > 60
    assert np.abs(back - pixels)[met].max() < 1e-8


def test_a_smooth_picture_comes_back():
    """Flattened, and made round again by the opposite map: cubic interpolation loses little."""
    u, v = np.moveaxis(pixel_grid(640, 480), -1, 0)
    picture = (127 + 60 * np.sin(u / 17) + 50 * np.cos(v / 23)).astype(np.uint8)
    flat = flat_camera(BARREL, "all")
    there = Flattener(BARREL, flat)(picture)
    back = Flattener(flat, BARREL)(there)
    inside = (slice(8, -8), slice(8, -8))
    assert np.abs(back[inside].astype(float) - picture[inside]).mean() < 1.0
    with pytest.raises(MixedImageSizes):
        Flattener(BARREL, flat)(picture[:100])
