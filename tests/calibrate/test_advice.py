"""Advice: silence when all is well, and the right sentence with its number when it is not."""

from dataclasses import replace

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.advice import advice
from vision_robot.errors import BadParameter

SIZE = (1280, 960)
GOOD = CAMERAS["pinhole"]


def solved(views, corners=None, **options):
    settings = Settings(**{"model": views.camera.model, **options})
    return calibrate(views.corners if corners is None else corners, views.board, SIZE, settings)


def said(sentences, *words):
    return [s for s in sentences if all(word in s for word in words)]


@pytest.mark.parametrize("seed", range(3))
def test_a_good_calibration_gets_none(seed):
    assert advice(solved(make_views(GOOD, 30, seed=seed)), wanted_px=0.5) == []


def test_too_few_views_for_what_is_wanted():
    result = solved(make_views(GOOD, 15))
    sentence, *others = advice(result, wanted_px=0.2)
    assert "0.38 px, 0.2 px are asked for: about 40 more" in sentence
    assert advice(result) == others
    with pytest.raises(BadParameter, match="wanted"):
        advice(result, wanted_px=0.0)


def test_a_part_of_the_picture_without_corners_is_named():
    views = make_views(CAMERAS["brown5"], 80, seed=3)
    corners = [v for v in views.corners if v.pixels[:, 0].max() < 900][:12]
    (sentence,) = said(advice(solved(views, corners)), "No corner was seen")
    assert "upper right corner (" in sentence
    assert "left" not in sentence


def test_little_tilt_and_tilts_in_one_direction():
    flat = make_views(GOOD, 20, seed=1, tilt=0.08)
    assert said(advice(solved(flat)), "lean by no more than", "°")
    views = make_views(GOOD, 150, seed=1)
    one_way = [v for v, n in zip(views.corners, views.cam_from_board.rotation[:, :, 2], strict=True)
               if abs(n[1]) < 0.06]  # fmt: skip
    (sentence,) = said(advice(solved(views, one_way)), "in one direction")
    assert "upper or lower edge" in sentence


def test_boards_at_one_distance():
    views = make_views(GOOD, 100, seed=1, tilt=0.3)
    distance = np.linalg.norm(views.cam_from_board.apply(views.board.mean(axis=0)[None])[:, 0], axis=1)
    alike = [v for v, d in zip(views.corners, distance, strict=True) if 0.75 < d < 0.85]
    assert len(alike) > 10
    (sentence,) = said(advice(solved(views, alike)), "as far away as the nearest")
    assert "1.1" in sentence


def test_a_bad_view_is_named():
    views = make_views(GOOD, 15)
    bad, rng = views.corners[4], np.random.default_rng(0)
    views.corners[4] = Corners(bad.image, bad.ids, bad.pixels + rng.normal(size=bad.pixels.shape))
    (sentence,) = said(advice(solved(views, robust=False)), "times the median view")
    assert sentence.startswith("View view 4 ")


def test_a_model_too_rich():
    """Six coefficients for a lens that needs none: what cannot be told is named, not called tied."""
    sentences = advice(solved(make_views(GOOD, 12), model="brown5"))
    assert said(sentences, "k3 = ", "from zero by two sigma")
    tied = advice(solved(make_views(CAMERAS["brown8"], 15, seed=0)))
    assert said(tied, "k1 and k4 are correlated by 1.0000", "simpler model")


def test_a_model_too_simple():
    slight = GOOD.parameters
    camera = replace(CAMERAS["brown5"], distortion=(-0.05, 0.0, 0.0, 0.0, 0.0)).with_parameters(
        np.r_[slight, -0.05, 0, 0, 0, 0]
    )
    sentences = advice(solved(make_views(camera, 15), model="pinhole", robust=False))
    assert said(sentences, "neighbouring corners", "too simple")


def test_what_is_undetermined_is_named():
    result = solved(make_views(GOOD, 12), model="brown5")
    covariance = replace(result.covariance, undetermined=("k2", "k3"))
    assert said(advice(replace(result, covariance=covariance)), "k2 and k3 cannot be told")
