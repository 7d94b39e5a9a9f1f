"""Advice: silence when all is well, and the right sentence with its number when it is not."""

import re
from dataclasses import replace

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.judgement.advice import advice, outlying_views
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
    (sentence,) = said(advice(solved(views, corners)), "No board corner was seen")
    assert "upper right corner (projection uncertain by" in sentence
    assert "left" not in sentence
    assert "no more than the order" not in sentence


def test_numbers_too_large_to_be_believed_are_called_so():
    """Corners in the middle alone leave the rim unknown by hundreds of pixels, written without exponent."""
    views = make_views(CAMERAS["brown5"], 150, seed=1)
    middle = [v for v in views.corners if np.linalg.norm(v.pixels - (650, 470), axis=1).max() < 330][:12]
    (sentence,) = said(advice(solved(views, middle)), "No board corner was seen")
    assert "tell no more than the order" in sentence
    assert "e+" not in sentence


def test_a_lens_that_folds_over_is_told():
    result = solved(make_views(CAMERAS["fisheye"], 8, seed=2))
    lost = np.isnan(result.camera.unproject(np.array([[0.0, 0.0], [650.0, 470.0]]))).any(axis=1)
    assert lost.tolist() == [True, False]
    assert said(advice(result), "folds over in", "has no ray there")
    assert not said(advice(solved(make_views(CAMERAS["fisheye"], 40, seed=2, tilt=0.6))), "folds over")


def test_little_tilt():
    flat = advice(solved(make_views(GOOD, 20, seed=1, tilt=0.08)))
    assert said(flat, "hardly tilted", "0 of 20 by 20° or more")


def test_one_steep_board_is_not_enough():
    """A single board 40 degrees off makes the largest tilt large, but alone decides the focal length."""
    flat, steep = make_views(GOOD, 12, seed=1, tilt=0.08), make_views(GOOD, 40, seed=1)
    angle = np.degrees(np.arccos(np.abs(steep.cam_from_board.rotation[:, 2, 2])))
    one = steep.corners[int(np.argmax(angle > 35))]
    corners = [*flat.corners, Corners("steep", one.ids, one.pixels)]
    assert said(advice(solved(flat, corners)), "hardly tilted", "1 of 13 by 20° or more")


@pytest.mark.parametrize(("along", "edges"), [(0, "left or right"), (1, "upper or lower")])
def test_tilts_about_one_axis_only(along, edges):
    views = make_views(GOOD, 150, seed=1)
    lean = np.abs(views.cam_from_board.rotation[:, along, 2])
    one_way = [v for v, n in zip(views.corners, lean, strict=True) if n < 0.06]
    (sentence,) = said(advice(solved(views, one_way)), "tilted about one axis")
    assert f"{edges} edge" in sentence


def test_boards_at_one_distance():
    views = make_views(GOOD, 100, seed=1, tilt=0.3)
    distance = np.linalg.norm(views.cam_from_board.apply(views.board.mean(axis=0)[None])[:, 0], axis=1)
    alike = [v for v, d in zip(views.corners, distance, strict=True) if 0.75 < d < 0.85]
    assert len(alike) > 10
    (sentence,) = said(advice(solved(views, alike)), "as far away as the nearest")
    assert "1.1" in sentence
    near, far = (int(mm) for mm in re.findall(r"at (\d+) mm", sentence)[::-1])
    assert 745 < near < far < 855


def test_few_views_are_told_and_many_are_not():
    assert said(advice(solved(make_views(GOOD, 5))), "Only 5 views were used")
    assert not said(advice(solved(make_views(GOOD, 12))), "views were used")


def test_bad_views_are_named_worst_first():
    views, rng = make_views(GOOD, 15), np.random.default_rng(0)
    for i, noise in ((4, 1.0), (9, 2.0)):
        bad = views.corners[i]
        views.corners[i] = Corners(bad.image, bad.ids, bad.pixels + noise * rng.normal(size=bad.pixels.shape))
    result = solved(views, robust=False)
    assert np.flatnonzero(outlying_views(result)).tolist() == [4, 9]
    (sentence,) = said(advice(result), "worse than the median view")
    assert sentence.startswith("view 9 (")
    assert " and view 4 (" in sentence


def test_of_many_bad_views_the_worst_are_named_and_the_rest_counted():
    views, rng = make_views(GOOD, 20), np.random.default_rng(0)
    for i in range(6):
        bad = views.corners[i]
        views.corners[i] = Corners(bad.image, bad.ids, bad.pixels + rng.normal(size=bad.pixels.shape))
    (sentence,) = said(advice(solved(views, robust=False)), "worse than the median view")
    assert "and 2 more fit" in sentence


def test_coefficients_of_a_lens_that_needs_none():
    (sentence,) = said(advice(solved(make_views(GOOD, 12), model="brown5")), "from zero by two sigma")
    assert "Taken one at a time, " in sentence
    assert re.search(r"k3 = -?0\.\d+ ± 0\.\d+", sentence)


def test_a_number_vaguer_than_ten_is_written_without_exponent():
    """Eight views cannot tell a rational lens: k3 comes out as a few units, give or take some ten."""
    sentences = advice(solved(make_views(CAMERAS["brown8"], 8, seed=1)))
    assert said(sentences, "k3 = ")
    assert not [s for s in sentences if re.search(r"\de[+-]\d", s)]


def test_two_coefficients_that_do_the_work_of_one():
    """k1 r^2 over 1 + k4 r^2: to first order only their difference is seen."""
    held = {"k3": 0.01, "k5": 0.02, "k6": 0.003}
    result = solved(make_views(CAMERAS["brown8"], 30), fixed=held)
    (sentence,) = said(advice(result), "correlated")
    assert sentence.startswith("k1 and k4 are correlated by 0.99")
    lost = replace(result, covariance=replace(result.covariance, undetermined=("k4",)))
    assert not said(advice(lost), "correlated")


def test_a_model_too_simple():
    slight = GOOD.parameters
    camera = replace(CAMERAS["brown5"], distortion=(-0.05, 0.0, 0.0, 0.0, 0.0)).with_parameters(
        np.r_[slight, -0.05, 0, 0, 0, 0]
    )
    sentences = advice(solved(make_views(camera, 15), model="pinhole", robust=False))
    assert said(sentences, "neighbouring corners", "too simple")


def test_what_is_undetermined_is_named_and_not_called_tied_as_well():
    """Six radial coefficients on ordinary views: numerator and denominator cancel."""
    result = solved(make_views(CAMERAS["brown8"], 15, seed=0))
    sentences = advice(result)
    assert {"k1", "k4"} <= set(result.covariance.undetermined)
    assert said(sentences, "These 15 views do not determine k1, k2, ", "no sigma is stated")
    assert not said(sentences, "correlated")
