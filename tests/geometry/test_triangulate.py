"""Triangulation: exact without noise, and its covariance is that of the errors, noise and rig alike."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, CameraRig, rotation_exp, triangulate

LEFT = Camera(1280, 960, 1000, 1010, 650, 470, 0, "brown5", (-0.28, 0.09, 1e-3, -5e-4, -0.01))
RIGHT = Camera(1280, 960, 1100, 1100, 630, 480, 0, "brown5", (-0.2, 0.05, 0, 0, 0))
FISH = Camera(640, 480, 260, 260, 322, 238, 0, "fisheye", (-0.02, 0.004, 0, 0))
POSES = SE3.from_rotvec(
    np.array([[0, 0, 0], [0.02, 0.3, -0.05], [-0.3, -0.1, 0.1]]),
    np.array([[0, 0, 0], [-0.3, 0.01, 0.05], [0.1, 0.25, 0.05]]),
)
RIG = CameraRig.exact(("left", "right", "fish"), (LEFT, RIGHT, FISH), POSES)
POINTS = np.random.default_rng(0).uniform([-0.15, -0.15, 0.8], [0.15, 0.15, 1.2], (40, 3))


def seen(rig: CameraRig, points: np.ndarray) -> np.ndarray:
    """Pixels (n, cameras, 2)."""
    each = [camera.project(rig.cam_from_rig[i].apply(points)) for i, camera in enumerate(rig.cameras)]
    return np.stack(each, axis=1)


def test_without_noise_it_is_exact():
    found = triangulate(RIG, seen(RIG, POINTS))
    assert np.abs(found.points - POINTS).max() < 1e-10
    assert found.rms_px.max() < 1e-8
    assert found.cameras.tolist() == [3] * 40


def test_two_cameras_are_enough_and_one_is_not():
    pixels = seen(RIG, POINTS)
    pixels[0, 2] = np.nan
    pixels[1, 1:] = np.nan
    found = triangulate(RIG, pixels)
    assert np.abs(found.points[0] - POINTS[0]).max() < 1e-9
    assert np.isnan(found.points[1]).all()
    assert np.isnan(found.covariance[1]).all()
    assert found.cameras[:3].tolist() == [2, 1, 3]
    assert np.isnan(found.residuals[0, 2]).all()


def test_parallel_rays_meet_nowhere():
    """Two cameras at one place see directions only."""
    rig = CameraRig.exact(("a", "b"), (LEFT, LEFT), SE3.identity(2))
    assert np.isnan(triangulate(rig, seen(rig, POINTS)).points).all()


def test_pixel_noise_is_in_the_covariance():
    rng = np.random.default_rng(1)
    clean = seen(RIG, POINTS)
    sigma = rng.uniform(0.1, 0.5, clean.shape[:2])
    chi = []
    for _ in range(40):
        found = triangulate(RIG, clean + rng.normal(size=clean.shape) * sigma[..., None], sigma)
        error = found.points - POINTS
        chi.append(np.einsum("ni,nij,nj->n", error, np.linalg.inv(found.covariance), error))
    # 1600 values of chi-square with three degrees of freedom.
    assert np.mean(chi) == pytest.approx(3, abs=4 * np.sqrt(6 / 1600))


def test_the_rigs_own_error_is_in_the_covariance():
    """Rigs drawn from a covariance move the points as it says."""
    rng = np.random.default_rng(2)
    affine, pose = [1.0, 1, 1, 1, 0], [1e-3, 1e-3, 1e-3, 5e-4, 5e-4, 5e-4]
    lens5, lens4 = [1e-3, 1e-3, 1e-4, 1e-4, 1e-3], [1e-3] * 4
    still = [0.0] * 6
    sigma = np.array([*affine, *lens5, *still, *affine, *lens5, *pose, *affine, *lens4, *pose])
    rig = CameraRig(RIG.names, RIG.cameras, RIG.cam_from_rig, np.diag(sigma**2))
    pixels = seen(RIG, POINTS[:5])
    stated = triangulate(rig, pixels, 1e-6)
    moved = []
    for _ in range(400):
        step = rng.normal(size=len(sigma)) * sigma
        cameras, rotations, translations = [], [], []
        for i, camera in enumerate(RIG.cameras):
            rows = step[rig.rows(i)]
            cameras.append(camera.with_parameters(camera.parameters + rows[:-6]))
            rotations.append(rotation_exp(rows[-6:-3]) @ POSES.rotation[i])
            translations.append(POSES.translation[i] + rows[-3:])
        other = CameraRig.exact(RIG.names, tuple(cameras), SE3(np.array(rotations), np.array(translations)))
        moved.append(triangulate(other, pixels).points - stated.points)
    found = np.std(moved, axis=0)
    assert np.abs(found / stated.sigma - 1).max() < 0.16


def test_wrong_counts_are_refused():
    with pytest.raises(BadParameter, match="3, the rig's"):
        triangulate(RIG, np.zeros((4, 2, 2)))
    with pytest.raises(BadParameter, match="sigma_px"):
        triangulate(RIG, np.zeros((4, 3, 2)), 0.0)
    with pytest.raises(BadParameter, match="different"):
        CameraRig.exact(("a", "a"), (LEFT, LEFT), SE3.identity(2))
