"""Predicted projection uncertainty against the spread of repeated calibrations, and its laws."""

from dataclasses import replace

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.judgement.projection_uncertainty import (
    expected_error,
    picture_grid,
    plane_sigma,
    projection_covariance,
    projection_covariance_at,
    projection_sigma,
    worst_sigma,
)
from vision_robot.errors import BadParameter
from vision_robot.evaluate import projection_difference, projection_error
from vision_robot.evaluate.projection import fitted_rotation
from vision_robot.geometry import SE3, rotation_exp, skew

SIZE = (1280, 960)
RUNS = 100
NOISE_PX = 0.05


TESTED = {"brown5": CAMERAS["brown5"], "fisheye": replace(CAMERAS["fisheye"], fx=600, fy=603)}
"""The fisheye's picture ends short of where noise may fold its four coefficients."""


def repeated(model: str):
    """A calibration of clean corners with the noise it would have had, and many of noisy ones."""
    views = make_views(TESTED[model], 12, seed=3, noise_px=0.0)
    rng = np.random.default_rng(7)
    runs = []
    for _ in range(RUNS):
        noisy = [
            Corners(v.image, v.ids, v.pixels + NOISE_PX * rng.normal(size=v.pixels.shape))
            for v in views.corners
        ]
        runs.append(calibrate(noisy, views.board, SIZE, Settings(model=model, robust=False)))
    return views, runs


@pytest.fixture(scope="module", params=TESTED)
def spread(request):
    return repeated(request.param)


def test_at_infinity_it_is_the_spread_of_calibrations_after_the_best_rotation(spread):
    views, runs = spread
    truth = views.camera
    grid = seen_grid(truth, 13, 9)
    predicted = projection_covariance(typical(truth, runs), grid)
    turns = [fitted_rotation(run.camera, truth) for run in runs]
    found = scatter(
        projection_difference(run.camera, truth, grid, rotation=turn)
        for run, turn in zip(runs, turns, strict=True)
    )
    # Over the whole picture, and at each place as far as 100 runs can tell.
    assert size(found) == pytest.approx(size(predicted), rel=0.15)
    ratio = worst_sigma(found) / worst_sigma(predicted)
    assert np.all((ratio > 0.7) & (ratio < 1.4))
    assert np.median(ratio) == pytest.approx(1, abs=0.15)


def test_at_the_boards_distance_it_is_the_spread_after_the_best_motion_of_the_boards(spread):
    views, runs = spread
    truth = views.camera
    corners = views.cam_from_board.apply(views.board).reshape(-1, 3)[::5]
    motions = [best_motion(run.camera, corners, truth.project(corners)) for run in runs]
    grid = seen_grid(truth, 7, 5)
    for distance in (0.3, 3.0):
        points = truth.unproject(grid) * distance
        found = scatter(
            run.camera.project(motion.apply(points)) - grid for run, motion in zip(runs, motions, strict=True)
        )
        predicted = projection_covariance_at(typical(truth, runs), grid, distance)
        assert size(found) == pytest.approx(size(predicted), rel=0.15)


def typical(truth, runs):
    """The true camera with the covariance that calibrations state on average."""
    shared = np.mean([run.covariance.shared for run in runs], axis=0)
    covariance = replace(runs[0].covariance, shared=shared)
    return replace(runs[0], camera=truth, covariance=covariance)


def seen_grid(camera, columns, rows):
    """Pixels (n, 2) over the picture that have a ray, a little inside the edge of the lens' field."""
    pixels = picture_grid(camera, columns, rows).reshape(-1, 2)
    outwards = 1.02 * (pixels - [camera.cx, camera.cy]) + [camera.cx, camera.cy]
    return pixels[np.isfinite(camera.unproject(outwards)).all(axis=-1)]


def scatter(moved):
    """Second moment (n, 2, 2) of displacements about the truth."""
    moved = np.array(list(moved))
    return np.einsum("rni,rnj->nij", moved, moved) / len(moved)


def size(covariance):
    return np.sqrt(np.mean(np.trace(covariance, axis1=-2, axis2=-1)))


def best_motion(camera, points, pixels):
    """Rigid motion of points after which the camera sees them at pixels (Gauss-Newton)."""
    motion = SE3.identity()
    for _ in range(3):
        moved = motion.apply(points)
        seen, in_point, _ = camera.project_jacobian(moved)
        P = np.concatenate([-in_point @ skew(moved), in_point], axis=-1).reshape(-1, 6)
        x = np.linalg.lstsq(P, (pixels - seen).ravel(), rcond=None)[0]
        motion = SE3(rotation_exp(x[:3]), x[3:]) @ motion
    return motion


@pytest.fixture(scope="module")
def result():
    views = make_views(CAMERAS["brown5"], 10, seed=1)
    return calibrate(views.corners, views.board, SIZE)


def test_a_direction_that_is_a_rotation_is_no_uncertainty(result):
    """A narrow pinhole camera whose only doubt is the principal point knows all but a turn."""
    covariance = np.zeros((5, 5))
    covariance[2, 2] = covariance[3, 3] = 4.0
    camera = replace(CAMERAS["pinhole"], fx=50_000, fy=50_000, cx=639.5, cy=479.5)
    known = result.covariance
    doubt = replace(known, shared=covariance, cross=known.cross[:, :5], intrinsic_count=5)
    doubtful = replace(result, camera=camera, covariance=doubt)
    assert projection_sigma(doubtful).max() < 1e-3


def test_it_grows_with_the_square_root_of_the_covariance_and_towards_the_rim(result):
    sigma = projection_sigma(result)
    fourfold = replace(result.covariance, shared=4 * result.covariance.shared)
    assert projection_sigma(replace(result, covariance=fourfold)) == pytest.approx(2 * sigma)
    assert sigma.shape == (48, 64)
    rim = np.concatenate([sigma[0], sigma[-1], sigma[:, 0], sigma[:, -1]])
    assert rim.mean() > 2 * sigma[20:28, 28:36].mean()


def test_points_where_the_boards_stood_are_known_best(result):
    grid = picture_grid(result.camera, 7, 5)
    near, there, far = (size(projection_covariance_at(result, grid, d)) for d in (0.1, 0.6, 6.0))
    assert there < near
    assert there < far


def test_where_the_lens_has_no_ray_there_is_no_number(result):
    folding = result.camera.with_parameters(np.r_[result.camera.parameters[:5], -0.9, 0, 0, 0, 0])
    sigma = projection_sigma(replace(result, camera=folding))
    assert np.isnan(sigma[0, 0])
    assert np.isfinite(sigma[24, 32])


@pytest.mark.parametrize("distance", [0.0, -1.0, np.nan, np.inf])
def test_a_distance_is_positive(result, distance):
    with pytest.raises(BadParameter, match="distance"):
        projection_covariance_at(result, np.zeros((1, 2)), distance)


def test_worst_sigma_is_the_root_of_the_largest_eigenvalue():
    covariance = np.array([[4.0, 1.0], [1.0, 9.0]])
    assert worst_sigma(covariance) == pytest.approx(np.sqrt(np.linalg.eigvalsh(covariance)[-1]))


def test_the_error_over_the_whole_picture_is_foretold_with_its_spread(spread):
    views, runs = spread
    found = np.array([projection_error(run.camera, views.camera, fit_rotation=True).rms_px for run in runs])
    foretold = expected_error(typical(views.camera, runs))
    assert np.sqrt(np.mean(found**2)) == pytest.approx(foretold.expected_px, rel=0.15)
    inside = np.mean((found >= foretold.low_px) & (found <= foretold.high_px))
    # 95 of 100, within three binomial standard deviations.
    assert inside >= 0.88
    # The interval is not made wide to hold them.
    assert foretold.high_px < 3.2 * foretold.expected_px


def test_millimetres_on_a_plane_are_pixels_over_the_focal_length():
    """Without a lens a pixel covers distance / f of a plane that faces the camera, fx and fy alike."""
    views = make_views(replace(CAMERAS["pinhole"], fy=1000.0), 10, seed=3)
    result = calibrate(views.corners, views.board, (1280, 960), Settings(model="pinhole"))
    pixels = np.array([[[640.0, 480.0], [100.0, 200.0]]])
    on_plane = plane_sigma(result, pixels, 0.7)
    rays = result.camera.unproject(pixels)
    for i in range(2):
        reach = 0.7 / rays[0, i, 2]
        in_px = worst_sigma(projection_covariance_at(result, pixels[0, i], reach))
        assert on_plane[0, i] == pytest.approx(in_px * 0.7 / result.camera.fx, rel=0.01)
    with pytest.raises(BadParameter, match="distance"):
        plane_sigma(result, pixels, 0.0)
