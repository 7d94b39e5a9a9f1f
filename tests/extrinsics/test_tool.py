"""A tool's tip from pictures and from touches: truth within sigma, what a motion leaves unknown."""

import numpy as np
import pytest

from tests.extrinsics.table import CAMERA, looking_down
from vision_robot.errors import BadParameter, TooLittleMotion
from vision_robot.extrinsics.pivot import fit_pivot
from vision_robot.extrinsics.plane_checks import pose_difference
from vision_robot.extrinsics.tip_view import TipView
from vision_robot.extrinsics.tool import fit_tool
from vision_robot.extrinsics.tool_start import pose_from_points
from vision_robot.geometry import SE3, KnownCamera, rotation_exp

TIP = np.array([0.012, -0.007, 0.19])
DOWN = np.diag([1.0, -1.0, -1.0])
KNOWN = KnownCamera.exact(CAMERA)
PLACES = [looking_down(40, 0.9, 20), looking_down(35, 0.8, 110)]


def robot(count: int = 15, *, tilt: float = 0.5, seed: int = 0, spread: float = 0.12) -> SE3:
    """base_from_wrist over a table, pointing down, turned about the vertical and tilted by `tilt` [rad]."""
    rng = np.random.default_rng(seed)
    turn = rotation_exp(np.column_stack([np.zeros((count, 2)), rng.uniform(-1.5, 1.5, count)]))
    lean = rotation_exp(np.column_stack([rng.uniform(-tilt, tilt, (count, 2)), np.zeros(count)]))
    place = rng.uniform([-spread, -spread, 0.22], [spread, spread, 0.36], (count, 3))
    return SE3(turn @ lean @ DOWN, place)


def seen(poses: SE3, place: SE3, *, noise_px: float = 0.1, seed: int = 0) -> np.ndarray:
    pixels = CAMERA.project(place.apply(poses.apply(TIP[None])[:, 0]))
    return pixels + noise_px * np.random.default_rng([seed, 5]).normal(size=pixels.shape)


def views(poses: SE3, *, placed: bool, cameras: int = 1, **kwargs) -> list[TipView]:
    return [
        TipView(f"cam{i}", KNOWN, seen(poses, PLACES[i], **kwargs), 1.0, PLACES[i] if placed else None)
        for i in range(cameras)
    ]


@pytest.mark.parametrize("placed", [True, False])
@pytest.mark.parametrize("cameras", [1, 2])
def test_without_noise_it_is_the_truth(placed, cameras):
    poses = robot()
    fit = fit_tool(poses, views(poses, placed=placed, cameras=cameras, noise_px=0))
    assert np.abs(fit.tip - TIP).max() < 1e-9
    for i in range(cameras):
        assert np.abs(pose_difference(fit.cam_from_base[i], PLACES[i])).max() < 1e-8


@pytest.mark.parametrize("placed", [True, False])
def test_the_covariance_holds_the_truth(placed):
    chi = []
    for seed in range(40):
        poses = robot(seed=seed)
        fit = fit_tool(poses, views(poses, placed=placed, seed=seed))
        error = fit.tip - TIP
        chi.append(error @ np.linalg.solve(fit.covariance, error))
    # Chi-square with three degrees of freedom, widened by the noise being told by about 20 residuals.
    assert np.mean(chi) == pytest.approx(3.3, abs=4 * np.sqrt(8 / 40))


def test_a_known_places_error_is_in_the_covariance():
    poses = robot()
    sigma = np.array([2e-3, 2e-3, 2e-3, 1e-3, 1e-3, 1e-3])
    clean = views(poses, placed=True, noise_px=0)[0]
    view = TipView("cam", KNOWN, clean.pixels, 1.0, PLACES[0], np.diag(sigma**2))
    stated = fit_tool(poses, [view]).sigma
    rng = np.random.default_rng(0)
    errors = []
    for _ in range(200):
        step = rng.normal(size=6) * sigma
        moved = SE3(rotation_exp(step[:3]) @ PLACES[0].rotation, PLACES[0].translation + step[3:])
        wrong = TipView("cam", KNOWN, clean.pixels, 1.0, moved)
        errors.append(fit_tool(poses, [wrong], robust=False).tip - TIP)
    assert np.std(errors, axis=0) / stated == pytest.approx([1, 1, 1], abs=0.2)


def test_a_wrong_sighting_is_left_out_by_name():
    poses = robot(20)
    view = views(poses, placed=False)[0]
    view.pixels[4] += [9, -5]
    fit = fit_tool(poses, [view])
    assert fit.rejected == (("cam0", 4),)
    assert np.abs(fit.tip - TIP).max() < 1e-3


def test_sightings_may_be_missing():
    poses = robot(20)
    view = views(poses, placed=False, noise_px=0)[0]
    view.pixels[[2, 7]] = np.nan
    fit = fit_tool(poses, [view])
    assert np.abs(fit.tip - TIP).max() < 1e-8
    assert np.isnan(fit.residuals[0, [2, 7]]).all()


def test_an_arm_that_never_tilts_leaves_the_tools_length_unknown():
    """Turning about the vertical only, the camera may as well stand higher and the tool be longer."""
    poses = robot(tilt=0.0)
    with pytest.raises(TooLittleMotion, match=r"the tip along the wrist's z axis cannot.*never tilts"):
        fit_tool(poses, views(poses, placed=False))
    with pytest.raises(TooLittleMotion, match=r"along the wrist's z axis .*tilt it by 15 degrees"):
        fit_pivot(robot(tilt=0.0))
    # A camera whose place is known sees the tip where it is.
    assert np.abs(fit_tool(poses, views(poses, placed=True, noise_px=0)).tip - TIP).max() < 1e-9


def test_an_arm_that_never_turns_leaves_all_of_it_unknown():
    still = robot()
    still = SE3(np.broadcast_to(DOWN, (15, 3, 3)), still.translation)
    with pytest.raises(TooLittleMotion, match=r"the whole tip cannot be known.*never turns"):
        fit_tool(still, views(still, placed=False))
    with pytest.raises(TooLittleMotion):
        fit_pivot(still)


def test_too_few_sightings_and_wrong_counts_are_refused():
    poses = robot(5)
    with pytest.raises(BadParameter, match="at least 6"):
        fit_tool(poses, views(poses, placed=False))
    with pytest.raises(BadParameter, match="5, one for each robot pose"):
        fit_tool(poses, [TipView("a", KNOWN, np.zeros((3, 2)))])
    with pytest.raises(BadParameter, match="one or more"):
        fit_tool(poses, [])


def touching(count: int, *, noise_m: float, seed: int = 0, tilt: float = 0.6) -> SE3:
    """Poses whose tip is at one point."""
    poses = robot(count, seed=seed, tilt=tilt)
    point = np.array([0.35, 0.1, 0.02])
    noise = noise_m * np.random.default_rng([seed, 9]).normal(size=(count, 3))
    return SE3(poses.rotation, point - poses.rotation @ TIP + noise)


def test_pivot():
    exact = fit_pivot(touching(6, noise_m=0))
    assert np.abs(exact.tip - TIP).max() < 1e-12
    assert exact.point_in_base == pytest.approx([0.35, 0.1, 0.02])
    chi = []
    for seed in range(200):
        fit = fit_pivot(touching(12, noise_m=5e-4, seed=seed))
        error = fit.tip - TIP
        chi.append(error @ np.linalg.solve(fit.covariance, error))
    assert np.mean(chi) == pytest.approx(3.2, abs=4 * np.sqrt(6.5 / 200))
    with pytest.raises(BadParameter, match="at least 4"):
        fit_pivot(touching(3, noise_m=0))
    poses = touching(12, noise_m=1e-4)
    slipped = poses.translation.copy()
    slipped[5] += [0.01, 0, 0]
    assert 5 in fit_pivot(SE3(poses.rotation, slipped)).worst


@pytest.mark.parametrize("flat", [False, True])
def test_a_cameras_pose_from_points_in_space(flat):
    points = np.random.default_rng(0).uniform(-0.15, 0.15, (12, 3)) * [1, 1, 0 if flat else 1]
    pose = pose_from_points(CAMERA, points, CAMERA.project(PLACES[0].apply(points)))
    assert pose is not None
    assert np.abs(pose_difference(pose, PLACES[0])).max() < 1e-8
    line = points * [1, 0, 0]
    assert pose_from_points(CAMERA, line, CAMERA.project(PLACES[0].apply(line))) is None
