"""The work plane's covariance is what small errors of pixel, camera, pose and height do to a position."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, WorkPlane, pixel_grid, rotation_exp

PINHOLE = Camera(640, 480, 500, 520, 300, 260)
BROWN5 = Camera(640, 480, 500, 520, 300, 260, 1.5, "brown5", (-0.2, 0.05, 0.001, 0.002, 0))
FISHEYE = Camera(640, 480, 220, 220, 300, 260, 0, "fisheye", (-0.02, 0.004, 0, 0))
TILTED = SE3.from_rotvec(np.array([2.4, -0.2, 0.1]), np.array([0.02, -0.05, 0.8]))
LEVEL = SE3(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), np.array([0, 0.5, 0]))
PIXELS = pixel_grid(640, 480)[40::130, 40::140].reshape(-1, 2)


def moved(plane: WorkPlane, step: np.ndarray) -> WorkPlane:
    """The plane with its parameters stepped as CONVENTIONS.md says."""
    pose = plane.cam_from_station
    turned = SE3(rotation_exp(step[-6:-3]) @ pose.rotation, pose.translation + step[-3:])
    return WorkPlane.exact(plane.camera.with_parameters(plane.camera.parameters + step[:-6]), turned)


@pytest.mark.parametrize("camera", [PINHOLE, BROWN5, FISHEYE], ids=["pinhole", "brown5", "fisheye"])
@pytest.mark.parametrize("z_m", [0.0, 0.03])
def test_each_part_of_the_covariance_is_what_a_finite_step_does(camera, z_m):
    plane = WorkPlane.exact(camera, TILTED)
    size = len(plane.parameter_names)
    for k in range(size):
        unit = np.zeros(size)
        unit[k] = 1e-6 * max(abs(camera.parameters[k]) if k < 4 else 1.0, 1e-3)
        ahead = moved(plane, unit).measure(PIXELS, z_m=z_m)[0]
        behind = moved(plane, -unit).measure(PIXELS, z_m=z_m)[0]
        stepped = (ahead - behind) / 2
        single = WorkPlane(camera, TILTED, np.diag(unit**2))
        covariance = single.measure(PIXELS, z_m=z_m)[1]
        expected = stepped[:, :, None] * stepped[:, None, :]
        assert np.isfinite(stepped).all(axis=1).sum() >= 8
        assert np.allclose(covariance, expected, rtol=1e-4, atol=1e-22, equal_nan=True)


def test_pixel_noise_and_height_are_what_a_finite_step_does():
    plane = WorkPlane.exact(BROWN5, TILTED)
    step = 1e-4
    columns = [
        (plane.measure(PIXELS + d)[0] - plane.measure(PIXELS - d)[0]) / 2 / step for d in step * np.eye(2)
    ]
    J = np.stack(columns, axis=-1)
    assert np.allclose(plane.measure(PIXELS, 0.3)[1], 0.09 * J @ J.transpose(0, 2, 1), rtol=1e-6)
    up = (plane.measure(PIXELS, z_m=1e-5)[0] - plane.measure(PIXELS, z_m=-1e-5)[0]) / 2e-5
    raised = plane.measure(PIXELS, sigma_z_m=0.002)[1]
    assert np.allclose(raised, 4e-6 * up[:, :, None] * up[:, None, :], rtol=1e-6)


def test_each_pixel_may_have_its_own_sigma():
    plane = WorkPlane.exact(BROWN5, TILTED)
    sigma = np.linspace(0.1, 1, len(PIXELS))
    each = plane.measure(PIXELS, sigma)[1]
    assert np.allclose(each, plane.measure(PIXELS, 1.0)[1] * sigma[:, None, None] ** 2)


@pytest.mark.parametrize("camera", [PINHOLE, BROWN5, FISHEYE], ids=["pinhole", "brown5", "fisheye"])
def test_positions_and_pixels_are_inverse(camera):
    plane = WorkPlane.exact(camera, TILTED)
    positions = plane.measure(PIXELS, z_m=-0.02)[0]
    met = np.isfinite(positions[:, 0])
    assert met.sum() >= 8
    assert np.abs(plane.pixels(positions[met], z_m=-0.02) - PIXELS[met]).max() < 1e-8


def test_joint_covariance_has_the_single_ones_on_its_diagonal_and_knows_lengths_better():
    rng = np.random.default_rng(0)
    root = rng.normal(size=(16, 16)) * ([1.0] * 5 + [1e-3] * 5 + [1e-3] * 6)
    plane = WorkPlane(BROWN5, TILTED, root.T @ root)
    single = plane.measure(PIXELS, 0.2)[1]
    joint = plane.joint_covariance(PIXELS, 0.2)
    for i, own in enumerate(single):
        assert np.allclose(joint[2 * i : 2 * i + 2, 2 * i : 2 * i + 2], own)
    assert np.linalg.eigvalsh(joint).min() > 0
    # Two neighbouring pixels share nearly all of the plane's error, so their difference has little of it.
    near = plane.joint_covariance(np.array([[300.0, 200], [301, 200]]))
    difference = near[:2, :2] + near[2:, 2:] - near[:2, 2:] - near[2:, :2]
    assert np.trace(difference) < 1e-4 * np.trace(near[:2, :2])


def test_nothing_above_the_horizon_or_outside_the_lens():
    plane = WorkPlane.exact(PINHOLE, LEVEL)
    positions, covariance = plane.measure(np.array([[300.0, 400], [300, 260], [300, 100]]), 0.1)
    assert np.isfinite(positions).all(axis=1).tolist() == [True, False, False]
    assert np.isfinite(covariance).all(axis=(1, 2)).tolist() == [True, False, False]
    barrel = Camera(640, 480, 300, 300, 320, 240, 0, "brown5", (-0.5, 0, 0, 0, 0))
    outside = WorkPlane.exact(barrel, TILTED).measure(np.array([[0.0, 0.0]]))
    assert np.isnan(outside[0]).all()
    assert np.isnan(outside[1]).all()


def test_what_is_no_covariance_is_refused():
    good = np.eye(11)
    skewed, negative = good.copy(), good.copy()
    skewed[0, 1] = 0.5
    negative[3, 3] = -1
    for matrix, word in ((np.eye(5), "11 x 11"), (skewed, "symmetric"), (negative, "negative")):
        with pytest.raises(BadParameter, match=word):
            WorkPlane(PINHOLE, TILTED, matrix)
    with pytest.raises(BadParameter, match="finite"):
        WorkPlane(PINHOLE, TILTED, np.full((11, 11), np.nan))
