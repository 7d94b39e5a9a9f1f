"""Cameras: project and unproject undo each other, Jacobians are derivatives, OpenCV agrees."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera, pixel_grid

PINHOLE = Camera(640, 480, 500.0, 520.0, 310.2, 245.7)
BROWN5 = Camera(640, 480, 500, 520, 310.2, 245.7, 0.0, "brown5", (-0.28, 0.09, 0.001, -0.0007, -0.01))
BROWN8 = Camera(
    640, 480, 500, 520, 310.2, 245.7, 0.0, "brown8", (0.4, -0.1, 0.001, -0.0007, 0.02, 0.7, -0.05, 0.01)
)
FISHEYE = Camera(640, 480, 210, 212, 310.2, 245.7, 0.0, "fisheye", (-0.02, 0.006, -0.002, 0.0002))
SKEWED = Camera(640, 480, 500, 520, 310.2, 245.7, -3.5, "brown5", (-0.28, 0.09, 0.001, -0.0007, -0.01))
CAMERAS = [PINHOLE, BROWN5, BROWN8, FISHEYE, SKEWED]
IDS = ["pinhole", "brown5", "brown8", "fisheye", "skewed"]

coefficient = st.floats(-1, 1, allow_nan=False)


models = st.sampled_from(["pinhole", "brown5", "brown8", "fisheye"])
numbers = st.lists(coefficient, min_size=10, max_size=10)


def sane_camera(model: str, a: list[float]) -> Camera:
    """A camera with coefficients as real lenses have them, folded ones among them."""
    scales = {
        "pinhole": [],
        "brown5": [0.5, 0.3, 0.01, 0.01, 0.1],
        "brown8": [0.5, 0.3, 0.01, 0.01, 0.1, 0.5, 0.2, 0.1],
        "fisheye": [0.1, 0.03, 0.01, 0.003],
    }[model]
    k = tuple(float(x) * scale for x, scale in zip(a, scales, strict=False))
    f = 550.0 + 350 * a[8]
    fy = f * (1 + 0.2 * a[9])
    return Camera(640, 480, f, fy, 320 + 50 * a[0], 240 - 40 * a[1], 5 * a[2], model, k)


def rays_in_front(n: int, widest: float, seed: int = 0):
    rng = np.random.default_rng(seed)
    angle, azimuth = widest * np.sqrt(rng.random(n)), 2 * np.pi * rng.random(n)
    return np.stack([np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth), np.cos(angle)], axis=1)


@settings(max_examples=40, deadline=None)
@given(models, numbers)
def test_pixels_survive_the_way_out_and_back(model, a):
    """project(unproject(pixel)) is the pixel to 1e-9 px wherever a ray exists."""
    camera = sane_camera(model, a)
    pixels = pixel_grid(640, 480)[::16, ::16]
    rays = camera.unproject(pixels)
    exist = np.isfinite(rays).all(axis=-1)
    assert (np.isfinite(rays).any(axis=-1) == exist).all()
    assert np.allclose(np.linalg.norm(rays[exist], axis=-1), 1)
    back = camera.project(rays[exist])
    assert np.abs(back - pixels[exist]).max(initial=0) < 1e-9


@settings(max_examples=40, deadline=None)
@given(models, numbers)
def test_every_ray_that_is_seen_is_found_again(model, a):
    """The inverse misses nothing: each pixel that a valid ray makes leads back to that ray."""
    camera = sane_camera(model, a)
    rays = rays_in_front(2000, np.deg2rad(120))
    pixels = camera.project(rays)
    # A rational lens near its pole shows rays a hundred pictures away, to fewer digits.
    seen = np.isfinite(pixels).all(axis=1) & (np.abs(pixels) < 5000).all(axis=1)
    assert seen.any()
    back = camera.unproject(pixels[seen])
    assert np.isfinite(back).all()
    # At the very fold a ray moves by the square root of rounding.
    assert np.abs(camera.project(back) - pixels[seen]).max() < 1e-8  # as far as 5000 px out
    assert np.linalg.norm(back - rays[seen], axis=1).max() < 1e-6


@pytest.mark.parametrize("camera", CAMERAS, ids=IDS)
def test_the_axis_is_exact(camera):
    assert np.allclose(camera.project(np.array([0.0, 0, 2])), [camera.cx, camera.cy], atol=1e-12)
    assert np.allclose(camera.unproject(np.array([camera.cx, camera.cy])), [0, 0, 1], atol=1e-15)
    tiny = np.array([1e-14, -2e-14, 1.0])
    shift = camera.project(tiny) - (camera.cx, camera.cy)
    assert np.abs(shift).max() < 1e-10
    near = np.array([1e-9, -2e-9, 1.0])
    ideal = camera.without_distortion().project(near)
    assert np.allclose(camera.project(near), ideal, atol=1e-9)


@pytest.mark.parametrize("camera", CAMERAS, ids=IDS)
def test_distance_along_the_ray_does_not_matter(camera):
    rays = rays_in_front(100, np.deg2rad(40))
    assert np.allclose(camera.project(rays), camera.project(7.5 * rays), atol=1e-10)


@pytest.mark.parametrize("camera", CAMERAS, ids=IDS)
def test_jacobians_are_the_derivatives(camera):
    """Central differences, in the point and in every parameter."""
    points = rays_in_front(50, np.deg2rad(35)) * np.linspace(0.5, 3, 50)[:, None]
    pixels, in_point, in_parameters = camera.project_jacobian(points)
    assert np.allclose(pixels, camera.project(points), atol=1e-11)
    h = 1e-6
    for i in range(3):
        step = h * np.eye(3)[i]
        slope = (camera.project(points + step) - camera.project(points - step)) / (2 * h)
        assert np.allclose(in_point[:, :, i], slope, rtol=1e-7, atol=1e-5)
    parameters = camera.parameters
    for i, name in enumerate(camera.parameter_names):
        step = h * np.eye(len(parameters))[i]
        ahead, behind = camera.with_parameters(parameters + step), camera.with_parameters(parameters - step)
        slope = (ahead.project(points) - behind.project(points)) / (2 * h)
        assert np.allclose(in_parameters[:, :, i], slope, rtol=1e-7, atol=1e-5), name


def test_jacobian_on_the_axis():
    for camera in CAMERAS:
        _, in_point, in_parameters = camera.project_jacobian(np.array([[0.0, 0, 2]]))
        assert np.allclose(in_point[0], [[camera.fx / 2, camera.skew / 2, 0], [0, camera.fy / 2, 0]])
        assert np.isfinite(in_parameters).all()


@pytest.mark.parametrize("camera", [PINHOLE, BROWN5, BROWN8], ids=["pinhole", "brown5", "brown8"])
def test_projects_as_opencv(camera):
    points = rays_in_front(200, np.deg2rad(40)) * 3
    theirs, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), camera.K, np.array(camera.distortion))
    assert np.allclose(camera.project(points), theirs.reshape(-1, 2), atol=1e-10)


def test_projects_as_opencv_fisheye():
    points = rays_in_front(200, np.deg2rad(80)) * 3
    k = np.array(FISHEYE.distortion)
    theirs, _ = cv2.fisheye.projectPoints(points[:, None], np.zeros(3), np.zeros(3), FISHEYE.K, k)
    assert np.allclose(FISHEYE.project(points), theirs.reshape(-1, 2), atol=1e-10)


@pytest.mark.parametrize("camera", [BROWN5, BROWN8], ids=["brown5", "brown8"])
def test_undistorts_as_opencv_with_many_iterations(camera):
    pixels = pixel_grid(640, 480)[40:440:50, 40:600:70].reshape(-1, 2)
    stop = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 500, 1e-14)
    k = np.array(camera.distortion)
    theirs = cv2.undistortPoints(pixels[:, None], camera.K, k, P=camera.K, criteria=stop).reshape(-1, 2)
    assert np.allclose(camera.undistorted_pixels(pixels), theirs, atol=1e-6)


def test_behind_the_camera_there_is_nothing():
    points = np.array([[0.1, 0.2, -1.0], [0.0, 0.0, -1], [1, 0, 0], [np.nan, 0, 1]])
    for camera in (PINHOLE, BROWN5, BROWN8):
        assert np.isnan(camera.project(points)).all()
        assert not camera.sees(points).any()
        for table in camera.project_jacobian(points):
            assert np.isnan(table).all()


def test_a_fisheye_sees_behind_its_image_plane():
    ray = np.array([np.sin(1.8), 0, np.cos(1.8)])
    wide = Camera(1000, 1000, 200, 200, 499.5, 499.5, model="fisheye")
    assert wide.sees(ray)
    assert np.allclose(wide.project(ray), [499.5 + 200 * 1.8, 499.5])
    assert np.allclose(wide.unproject(wide.project(ray)), ray, atol=1e-14)
    assert np.isnan(wide.undistorted_pixels(wide.project(ray))).all()


def test_sees_ends_half_a_pixel_outside_the_outer_centres():
    pixels = np.array([[-0.49, 0], [-0.51, 0], [639.49, 479.49], [639.51, 0], [0, 479.51]])
    assert PINHOLE.sees(PINHOLE.unproject(pixels)).tolist() == [True, False, True, False, False]


def test_skew_shears_along_u():
    straight, skewed = BROWN5, SKEWED
    points = rays_in_front(20, 0.5)
    ideal = (straight.project(points)[:, 1] - straight.cy) / straight.fy
    shift = skewed.project(points) - straight.project(points)
    assert np.allclose(shift[:, 0], -3.5 * ideal)
    assert np.allclose(shift[:, 1], 0)


def test_shapes_follow_the_input():
    points = rays_in_front(12, 0.3).reshape(2, 2, 3, 3)
    assert BROWN5.project(points).shape == (2, 2, 3, 2)
    assert BROWN5.unproject(BROWN5.project(points)).shape == (2, 2, 3, 3)
    assert BROWN5.project(np.zeros((0, 3))).shape == (0, 2)
    assert BROWN5.unproject(np.zeros((0, 2))).shape == (0, 3)
    assert BROWN5.sees(points).shape == (2, 2, 3)


@pytest.mark.parametrize(
    "change",
    [
        {"width": 0},
        {"height": -3},
        {"fx": 0.0},
        {"fy": -1.0},
        {"cx": float("nan")},
        {"model": "brown6"},
        {"model": "brown5", "distortion": (0.1, 0.2)},
    ],
)
def test_impossible_cameras_are_refused(change):
    good = {"width": 640, "height": 480, "fx": 500.0, "fy": 500.0, "cx": 320.0, "cy": 240.0}
    with pytest.raises(BadParameter):
        Camera(**{**good, **change})


def test_parameters_round_trip():
    assert BROWN8.with_parameters(BROWN8.parameters) == BROWN8
    assert BROWN8.parameter_names[:5] == ("fx", "fy", "cx", "cy", "skew")
    assert BROWN8.without_distortion().K.tolist() == BROWN8.K.tolist()
