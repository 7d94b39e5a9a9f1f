"""The calibration page: it says what the numbers say, for good calibrations and for bad ones."""

from dataclasses import replace

import numpy as np
import pytest

from tests.report.test_page import Reader
from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Corners, Rejected, Settings, calibrate
from vision_robot.calibrate.boards import Chessboard
from vision_robot.calibrate.judgement.advice import advice
from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera
from vision_robot.report.calibration import calibration_page
from vision_robot.report.calibration_advice import remarks
from vision_robot.report.calibration_findings import find
from vision_robot.report.page import render_page

SIZE = (1280, 960)
HOSTILE = "<b>$x_1$</b> &amp; é漢.png"


def result_of(model="brown5", count=12, *, seed=2, rejected=(), rename=None, change=None, **settings):
    views = make_views(CAMERAS[model], count, seed=seed)
    corners = [replace(view, image=(rename or "{}.jpg").format(i)) for i, view in enumerate(views.corners)]
    for i, pixels in (change or {}).items():
        corners[i] = replace(corners[i], pixels=corners[i].pixels + pixels)
    return calibrate(corners, views.board, SIZE, Settings(model=model, **settings), rejected=rejected)


@pytest.fixture(scope="module")
def result():
    return result_of(rename=HOSTILE + " {}", rejected=[Rejected("<i>lost</i>", "no board found")])


@pytest.fixture(scope="module")
def html(result):
    rng = np.random.default_rng(0)
    images = {view.image: rng.integers(0, 255, (96, 128), dtype=np.uint8) for view in result.corners}
    page = calibration_page(
        result,
        board=Chessboard(11, 8, 0.03),
        truth=CAMERAS["brown5"],
        images=images,
        title="Camera <A>",
        command="vr calibrate --seed 2",
        seed=2,
    )
    return render_page(page)


def test_it_is_a_page_by_itself_and_small(html):
    reader = Reader(html)
    assert reader.tags.count("svg") == 13
    assert reader.tags.count("img") == 12
    assert "http" not in html
    assert "<script" not in html
    assert len(html) < 1_000_000


def test_names_of_pictures_stay_names(html):
    reader = Reader(html)
    assert "i" not in reader.tags
    text = "".join(reader.text)
    assert HOSTILE + " 3" in text
    assert "<i>lost</i>" in text
    assert "no board found" in text
    assert "Camera <A>" in text


def test_it_states_every_number_with_its_sigma(html, result):
    text = "".join(Reader(html).text).replace("\u00a0", " ")
    for name in ("fx", "fy", "cx", "cy"):
        value = getattr(result.camera, name)
        assert any(f"{value:.{d}f} ± {result.sigma[name]:.{d}f} px" in text for d in (0, 1, 2, 3))
    assert f"{result.rms_px:.3f} px rms per point" in text
    assert f"{result.noise_px:.3f} px" in text
    assert "12 of 13" in text
    assert "chessboard 11x8 inner corners, squares 30 mm" in text
    assert "vr calibrate --seed 2" in text
    assert "Vision Robot" in text


def test_the_same_calibration_is_the_same_page(result):
    assert render_page(calibration_page(result)) == render_page(calibration_page(result))


@pytest.mark.parametrize("model", ["pinhole", "brown8", "fisheye"])
def test_every_lens_has_its_page(model):
    result = result_of(model, 8)
    reader = Reader(render_page(calibration_page(result, truth=CAMERAS[model])))
    assert reader.tags.count("svg") == (11 if model == "pinhole" else 13)


def test_a_truth_of_another_model_is_compared_by_its_picture_alone():
    result = result_of("brown5", 8)
    truth = Camera(1280, 960, 1000, 1010, 650, 470)
    text = "".join(Reader(render_page(calibration_page(result, truth=truth))).text)
    assert "It misses the truth by" in text
    assert "error / σ" not in text


def test_a_truth_of_another_size_is_refused(result):
    with pytest.raises(BadParameter, match="camera size"):
        calibration_page(result, truth=Camera(640, 480, 500, 500, 320, 240))


def said(result, truth=None, tone=None):
    return " ".join(text for kind, text in remarks(find(result, truth)) if tone in (None, kind))


def test_the_cautions_are_the_advice_of_the_library():
    """Word for word and in its order, where there is much to say; a missed truth comes first."""
    simple = result_of("brown5", 7, fixed={"k2": 0.0, "k3": 0.0, "p1": 0.0, "p2": 0.0}, robust=False)
    cautions = [text for tone, text in remarks(find(simple)) if tone == "caution"]
    assert cautions == advice(simple)
    assert len(cautions) > 1
    missed, *others = (text for tone, text in remarks(find(simple, CAMERAS["brown5"])) if tone == "caution")
    assert missed.startswith("The truth lies farther away")
    assert others == cautions


def test_good_calibrations_are_called_good(result):
    assert "do not correlate measurably" in said(result, tone="good")
    assert "The truth lies where the stated uncertainty says" in said(result, CAMERAS["brown5"], "good")


def test_a_lens_model_too_simple_is_seen_in_the_residuals():
    held = {"k2": 0.0, "k3": 0.0, "p1": 0.0, "p2": 0.0}
    simple = result_of("brown5", 12, fixed=held, robust=False)
    assert "the lens model or the flat board is too simple" in said(simple, tone="caution")
    assert "do not correlate" not in said(simple)
    assert "The truth lies farther away" in said(simple, CAMERAS["brown5"], "caution")


@pytest.mark.parametrize(("z", "tone"), [(0.5, "good"), (3.0, "note"), (-3.0, None)])
def test_residuals_too_little_correlated_for_a_caution(result, z, tone):
    """Between good and a caution stands a note; residuals that avoid each other get neither."""
    findings = find(result)
    near = replace(findings.neighbours, value=z * findings.neighbours.sigma)
    said = [kind for kind, text in remarks(replace(findings, neighbours=near)) if "correlate" in text]
    assert said == ([tone] if tone else [])


def test_a_view_much_worse_than_the_rest_is_named_alike_in_remark_and_figure():
    noise = np.random.default_rng(0).normal(size=(88, 2))
    result = result_of(change={4: noise}, robust=False)
    assert "4.jpg (" in said(result, tone="caution")
    text = "".join(Reader(render_page(calibration_page(result))).text)
    assert "Much worse than the rest: view 5 (4.jpg)." in text


def test_coverage_is_called_good_only_where_nothing_is_missing():
    """The same lens seen by boards all over the picture, and by boards on its right alone."""
    views = make_views(CAMERAS["brown5"], 80, seed=3)
    right = [view for view in views.corners if view.pixels[:, 0].min() > 380][:12]
    good, gap = (
        calibrate(corners, views.board, SIZE, Settings(model="brown5")) for corners in (views.corners, right)
    )
    assert "The boards cover" in said(good, tone="good")
    assert "No board corner" not in said(good)
    assert "The boards cover" not in said(gap)
    assert "upper left corner" in said(gap, tone="caution")
    assert "lower left corner" in said(gap, tone="caution")


def test_corners_that_scatter_more_than_stated_are_told():
    views = make_views(CAMERAS["brown5"], 10, seed=2)
    rng = np.random.default_rng(0)
    stated = [
        Corners(view.image, view.ids, view.pixels, rng.uniform(0.04, 0.06, len(view)))
        for view in views.corners
    ]
    text = said(calibrate(stated, views.board, SIZE), tone="note")
    assert "times as much as their detector stated" in text
