"""Lenses that fold, reach a pole or see behind themselves: outside the valid field there is NaN."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.geometry import LENSES, Camera, lens_named, pixel_grid
from vision_robot.geometry.lens.lens import first_positive_root


def camera(model: str, *k: float) -> Camera:
    return Camera(1000, 1000, 500, 500, 499.5, 499.5, model=model, distortion=k)


def along_x(s):
    s = np.asarray(s, dtype=float)
    return np.stack([s, np.zeros_like(s), np.ones_like(s)], axis=-1)


def test_barrel_lens_folds_where_its_radius_stops_growing():
    """r = s - 0.5 s^3 has its maximum 0.5443 at s = sqrt(2/3)."""
    barrel = camera("brown5", -0.5, 0, 0, 0, 0)
    fold, reach = np.sqrt(2 / 3), np.sqrt(2 / 3) * 2 / 3
    assert np.isclose(barrel.lens.fold(barrel.distortion), fold)
    assert np.isfinite(barrel.project(along_x([0.1, fold - 1e-9]))).all()
    assert np.isnan(barrel.project(along_x([fold + 1e-9, 1.0, 1.2, 50]))).all()
    u = 499.5 + 500 * np.array([0, 0.5 * reach, reach - 1e-9, reach + 1e-9, 0.9])
    rays = barrel.unproject(np.stack([u, np.full(5, 499.5)], axis=-1))
    assert np.isfinite(rays).all(axis=1).tolist() == [True, True, True, False, False]
    assert (rays[:3, 0] / rays[:3, 2] <= fold).all()


def test_mask_and_picture_agree_beyond_the_fold():
    """The ring of the picture that no ray reaches is NaN in both directions, and only it."""
    barrel = camera("brown5", -0.5, 0, 0.0005, -0.0004, 0)
    rays = barrel.unproject(pixel_grid(1000, 1000)[::10, ::10])
    radius = np.hypot(*np.moveaxis(pixel_grid(1000, 1000)[::10, ::10] - 499.5, -1, 0)) / 500
    exist = np.isfinite(rays[..., 0])
    assert exist[radius < 0.543].all()
    assert not exist[radius > 0.546].any()
    assert barrel.sees(rays[exist]).all()
    assert not barrel.sees(rays[~exist]).any()


def test_strong_tangential_terms_reach_past_the_radial_fold():
    """Nothing that project shows is lost by unproject although p1 and p2 shift the fold by percents."""
    bent = camera("brown5", -0.4, 0, 0.03, -0.02, 0)
    s, azimuth = np.meshgrid(np.linspace(0, 1.2, 200), np.linspace(0, 2 * np.pi, 90))
    rays = np.stack([s * np.cos(azimuth), s * np.sin(azimuth), np.ones_like(s)], axis=-1)
    pixels = bent.project(rays)
    shown = np.isfinite(pixels[..., 0])
    assert 0.5 < shown.mean() < 1
    assert np.abs(bent.project(bent.unproject(pixels[shown])) - pixels[shown]).max() < 1e-9


def test_the_far_side_of_a_tangential_fold_is_not_seen():
    """With p1 alone v = y + 3 p1 y^2 turns at y = -1/(6 p1); past -1/(2 p1) the determinant recovers."""
    bent = camera("brown5", 0, 0, 0.01, 0, 0)
    y = np.array([-10, -16.6, -16.7, -30, -49, -51, -55])
    rays = np.stack([np.zeros(7), y, np.ones(7)], axis=1)
    assert bent.sees(rays).tolist() == [False] * 7  # none is in the picture
    assert np.isfinite(bent.project(rays)[:, 0]).tolist() == [True, True] + [False] * 5


def test_a_lens_folded_in_some_directions_only_shows_no_ghosts():
    """Nearly flat near s = 1.3, so that p2 folds one side, which unfolds again: no pixel has two rays."""
    bent = camera("brown5", 0, -0.1875, 0.0, 0.01, 0.05)
    rng = np.random.default_rng(0)
    s, azimuth = 3 * np.sqrt(rng.random(5000)), 2 * np.pi * rng.random(5000)
    rays = np.stack([s * np.cos(azimuth), s * np.sin(azimuth), np.ones_like(s)], axis=-1)
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    pixels = bent.project(rays)
    shown = np.isfinite(pixels[:, 0])
    assert 0.3 < shown.mean() < 0.95
    assert np.abs(bent.unproject(pixels[shown]) - rays[shown]).max() < 1e-6


def test_rational_lens_ends_at_its_pole():
    """With k4 = -1 the denominator vanishes at s = 1."""
    rational = camera("brown8", 0, 0, 0, 0, 0, -1, 0, 0)
    assert np.isclose(rational.lens.fold(rational.distortion), 1)
    pixels = rational.project(along_x([0.5, 0.99, 1.0, 1.5]))
    assert np.isclose(pixels[0, 0], 499.5 + 500 * 0.5 / 0.75)
    assert np.isfinite(pixels[:2]).all()
    assert np.isnan(pixels[2:]).all()
    rays = rational.unproject(pixels[:2])
    assert np.allclose(rays[:, 0] / rays[:, 2], [0.5, 0.99], rtol=1e-13)
    assert np.allclose(rational.project(rays), pixels[:2], atol=1e-9)


def test_pole_hidden_behind_a_fold_does_not_matter():
    both = camera("brown8", -0.5, 0, 0, 0, 0, 0, -0.01, 0)
    assert both.lens.fold(both.distortion) < 1


def test_fisheye_reaches_past_the_image_plane_but_not_straight_back():
    round_eye = camera("fisheye", 0, 0, 0, 0)
    angles = np.array([0.5, np.pi / 2, 2.5, np.pi])
    rays = np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=-1)
    rays[3] = 0, 0, -1
    pixels = round_eye.project(rays)
    assert np.allclose(pixels[:3, 0], 499.5 + 500 * angles[:3])
    assert np.isnan(pixels[3]).all()
    assert np.allclose(round_eye.unproject(pixels[:3]), rays[:3], atol=1e-14)
    assert np.isnan(round_eye.unproject(np.array([499.5 + 500 * 3.2, 499.5]))).all()


def test_folded_fisheye():
    """theta - 0.3 theta^3 stops growing at theta = 1.054."""
    eye = camera("fisheye", -0.3, 0, 0, 0)
    fold = np.sqrt(1 / 0.9)
    assert np.isclose(eye.lens.fold(eye.distortion), fold)
    angles = np.array([fold - 1e-6, fold + 1e-6])
    pixels = eye.project(np.stack([np.sin(angles), 0 * angles, np.cos(angles)], axis=-1))
    assert np.isfinite(pixels[0]).all()
    assert np.isnan(pixels[1]).all()
    beyond = eye.unproject(np.array([[499.5 + 500 * 0.75, 499.5], [499.5 + 500 * 0.6, 499.5]]))
    assert np.isnan(beyond[0]).all()
    assert np.isfinite(beyond[1]).all()


def test_infinite_and_unknown_pixels_have_no_ray():
    odd = np.array([[np.nan, 1], [np.inf, 1], [-np.inf, np.inf], [1e200, 0]])
    for model in LENSES:
        k = (-0.1,) + (0.0,) * (len(lens_named(model).coefficient_names) - 1) if model != "pinhole" else ()
        assert np.isnan(camera(model, *k).unproject(odd)).all(), model


@pytest.mark.parametrize(
    ("polynomial", "otherwise", "root"),
    [
        ([1, -1], 5.0, 1.0),
        ([1, 1], 5.0, 5.0),
        ([-6, 11, -6, 1], 5.0, 1.0),
        ([1, -1], 0.5, 0.5),
        ([1, 0, 0, 0], 7.0, 7.0),
        ([1, -1, 1e-320], 5.0, 1.0),
        ([1, -0.25, 1e-18, -1e-25], 3000.0, 4.0),
    ],
)
def test_first_positive_root(polynomial, otherwise, root):
    assert np.isclose(first_positive_root(polynomial, otherwise), root)


def test_unknown_lens_lists_the_known():
    with pytest.raises(BadParameter, match="pinhole, brown5, brown8, fisheye"):
        lens_named("brown6")
