"""`calibrate`: truth within its own sigma, honest covariance, words where it cannot know."""

import numpy as np
import pytest

from tests.views import CAMERAS, Views, make_views
from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.errors import BadParameter, DegenerateViews, TooFewViews

SIZE = (1280, 960)


def solve(views: Views, **options):
    return calibrate(views.corners, views.board, SIZE, Settings(model=views.camera.model, **options))


@pytest.mark.parametrize("model", CAMERAS)
@pytest.mark.parametrize("seed", range(3))
def test_every_parameter_is_within_five_sigma_of_the_truth(model, seed):
    views = make_views(CAMERAS[model], 15, seed=seed)
    result = solve(views)
    error = dict(
        zip(views.camera.parameter_names, result.camera.parameters - views.camera.parameters, strict=True)
    )
    assert {"fx", "fy", "cx", "cy"} <= set(result.sigma)
    assert all(abs(error[name]) <= 5 * sigma for name, sigma in result.sigma.items())
    assert result.rms_px == pytest.approx(0.2 * np.sqrt(2), rel=0.1)


def test_the_covariance_is_the_spread_of_repeated_calibrations():
    truth = make_views(CAMERAS["brown5"], 10, seed=0, noise_px=0.0)
    rng = np.random.default_rng(1)
    errors = []
    for _ in range(150):
        noisy = [
            Corners(v.image, v.ids, v.pixels + 0.2 * rng.normal(size=v.pixels.shape)) for v in truth.corners
        ]
        errors.append(calibrate(noisy, truth.board, SIZE).camera.parameters - truth.camera.parameters)
    result = solve(make_views(CAMERAS["brown5"], 10, seed=0))
    free = np.array(result.free)
    ratio = np.std(errors, axis=0)[free] / result.covariance.sigma[free]
    assert (np.abs(ratio - 1) < 0.25).all(), ratio


def test_skew_is_found_when_asked_for():
    camera = CAMERAS["brown5"].with_parameters(
        np.array([1000, 1010, 650, 470, 2.0, -0.28, 0.09, 1e-3, -5e-4, -0.01])
    )
    result = solve(make_views(camera, 15), skew=True)
    assert abs(result.camera.skew - 2) < 5 * result.sigma["skew"]
    assert solve(make_views(camera, 15)).camera.skew == 0


def test_fixed_coefficients_stay_zero_and_get_no_sigma():
    result = solve(make_views(CAMERAS["brown5"], 8), fixed={"p1": 0, "p2": 0, "k3": 0})
    assert result.camera.distortion[2:] == (0, 0, 0)
    assert "k3" not in result.sigma
    with pytest.raises(BadParameter, match="skew, k1, k2"):
        solve(make_views(CAMERAS["brown5"], 8), fixed={"k9": 0})


@pytest.mark.parametrize("tilt", [0.0, 1e-3, 1e-2])
def test_parallel_views_are_refused_by_name(tilt):
    with pytest.raises(DegenerateViews) as caught:
        solve(make_views(CAMERAS["brown5"], 10, tilt=tilt))
    assert {"fx", "fy"} <= set(caught.value.undetermined)


def test_coefficients_of_a_lens_that_is_too_rich_get_no_sigma():
    """brown8 on views that brown5 explains: its fractions cancel, and no sigma of them is honest."""
    views = make_views(CAMERAS["brown5"], 15, seed=8)
    result = calibrate(views.corners, views.board, SIZE, Settings(model="brown8"))
    assert {"k1", "k4"} <= set(result.covariance.undetermined)
    assert not {"k1", "k4"} & set(result.sigma)
    assert {"fx", "fy", "cx", "cy"} <= set(result.sigma)
    assert solve(views).covariance.undetermined == ()


def test_too_few_views_say_how_many():
    views = make_views(CAMERAS["brown5"], 2)
    with pytest.raises(TooFewViews, match="2 usable view"):
        solve(views)


def test_a_view_of_one_line_is_left_out_with_the_reason():
    views = make_views(CAMERAS["brown5"], 6)
    first = views.corners[0]
    views.corners[0] = Corners(first.image, first.ids[:11], first.pixels[:11])
    result = solve(views)
    assert [(r.image, "one line" in r.reason) for r in result.rejected] == [("view 0", True)]


def test_the_unit_of_the_board_only_scales_the_poses():
    views = make_views(CAMERAS["brown5"], 8)
    metres, inches = solve(views), calibrate(views.corners, views.board / 0.0254, SIZE)
    difference = inches.camera.parameters - metres.camera.parameters
    assert (np.abs(difference) <= 0.01 * metres.covariance.sigma).all()
    np.testing.assert_allclose(
        inches.cam_from_board.translation * 0.0254, metres.cam_from_board.translation, rtol=1e-4, atol=1e-6
    )


def test_views_may_show_parts_of_the_board():
    views = make_views(CAMERAS["brown5"], 12)
    rng = np.random.default_rng(0)
    partial = []
    for view in views.corners:
        keep = np.sort(rng.choice(88, 50, replace=False))
        partial.append(Corners(view.image, view.ids[keep], view.pixels[keep]))
    result = calibrate(partial, views.board, SIZE)
    error = np.abs(result.camera.parameters - views.camera.parameters)[np.array(result.free)]
    assert (error < 5 * result.covariance.sigma[np.array(result.free)]).all()


def test_a_wrong_corner_is_named_and_left_out():
    views = make_views(CAMERAS["brown5"], 10, seed=5)
    spoiled = views.corners[3]
    pixels = spoiled.pixels.copy()
    pixels[17] += [9.0, -4.0]
    views.corners[3] = Corners(spoiled.image, spoiled.ids, pixels)
    result = solve(views)
    assert [(r.image, r.corner) for r in result.rejected] == [("view 3", 17)]
    assert result.rms_px == pytest.approx(0.2 * np.sqrt(2), rel=0.1)
    assert 17 not in result.corners[3].ids
    assert solve(views, robust=False).rms_px > 1.15 * result.rms_px


def test_a_wrong_view_is_named_and_left_out():
    """A view of corners in the wrong order pulls on every parameter, but not past the robust fit."""
    views = make_views(CAMERAS["brown5"], 12, seed=6)
    spoiled = views.corners[4]
    rng = np.random.default_rng(0)
    pixels = spoiled.pixels + rng.normal(size=spoiled.pixels.shape) * 15
    views.corners[4] = Corners(spoiled.image, spoiled.ids, pixels)
    result = solve(views)
    assert [(r.image, r.corner) for r in result.rejected] == [("view 4", None)]
    assert len(result.corners) == 11
    assert result.rms_px == pytest.approx(0.2 * np.sqrt(2), rel=0.1)


def test_clean_views_lose_nothing():
    for seed in range(5):
        assert solve(make_views(CAMERAS["brown5"], 10, seed=seed)).rejected == ()


def test_a_prior_counts_as_one_more_measurement():
    views = make_views(CAMERAS["brown5"], 6, seed=7)
    free = solve(views)
    sigma = free.sigma["cx"]
    pulled = solve(views, priors={"cx": (free.camera.cx + sigma, sigma)})
    assert pulled.camera.cx == pytest.approx(free.camera.cx + sigma / 2, abs=0.05 * sigma)
    assert pulled.sigma["cx"] == pytest.approx(sigma / np.sqrt(2), rel=0.05)
    firm = solve(views, priors={"cx": (600.0, 1e-6)})
    assert firm.camera.cx == pytest.approx(600.0, abs=1e-4)


def test_a_parameter_is_fixed_at_its_value():
    result = solve(make_views(CAMERAS["brown5"], 6), fixed={"cx": 650.0, "cy": 470.0})
    assert (result.camera.cx, result.camera.cy) == (650, 470)
    assert "cx" not in result.sigma


@pytest.mark.parametrize(
    "options",
    [{"priors": {"cx": (1, 0)}}, {"fixed": {"cx": 1}, "priors": {"cx": (1, 1)}}, {"warp": 99}, {"warp": -1}],
)
def test_settings_that_make_no_sense_are_refused(options):
    with pytest.raises(BadParameter):
        Settings(**options)
