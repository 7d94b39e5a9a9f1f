"""The work plane from a board on the table: truth within its sigma, refusals in words."""

import numpy as np
import pytest

from tests.extrinsics.table import BOARD, CAMERA, looking_down, lying, seen
from vision_robot.calibrate import Corners
from vision_robot.errors import AmbiguousPlane, BadParameter, EdgeOnPlane, UnlevelBoard
from vision_robot.extrinsics.plane import fit_plane, on_station
from vision_robot.extrinsics.plane_checks import pose_difference
from vision_robot.geometry import SE3, KnownCamera

EXACT = KnownCamera.exact(CAMERA)
POSE = looking_down()


def mahalanobis(step: np.ndarray, covariance: np.ndarray) -> float:
    scale = 1 / np.sqrt(np.diag(covariance))
    return float(step * scale @ np.linalg.solve(covariance * scale[:, None] * scale, step * scale))


def test_without_noise_it_is_the_truth():
    fit = fit_plane(EXACT, [seen(CAMERA, POSE, lying(), noise_px=0)], BOARD, lying())
    assert np.abs(pose_difference(POSE, fit.plane.cam_from_station)).max() < 1e-9
    assert fit.rms_px < 1e-9
    assert np.degrees(fit.elevation) == pytest.approx(60, abs=3)


@pytest.mark.parametrize(
    ("offset", "yaw", "height", "z_up"),
    [((0.1, -0.2), 0.4, 0.003, True), ((0.1, 0.2), -2.0, 0.01, False), ((0, 0), 0.0, 0.0, True)],
)
def test_where_the_board_lies_on_the_table(offset, yaw, height, z_up):
    """Point 0 at the offset, x turned by yaw, the face at its height above the plane, up or down."""
    laid = on_station(offset, yaw, height, z_up=z_up)
    assert laid.translation.tolist() == [*offset, height if z_up else -height]
    assert np.allclose(laid.rotation[:, 0], [np.cos(yaw), np.sin(yaw), 0])
    assert np.allclose(laid.rotation[:, 2], [0, 0, -1 if z_up else 1])
    assert np.linalg.det(laid.rotation) == pytest.approx(1)


def test_one_photo_covers_the_truth_as_often_as_it_says():
    distances = []
    for seed in range(60):
        fit = fit_plane(EXACT, [seen(CAMERA, POSE, lying(), seed=seed)], BOARD, lying())
        step = pose_difference(fit.plane.cam_from_station, POSE)
        distances.append(mahalanobis(step, fit.plane.pose_covariance))
    # Chi-square with six degrees of freedom: mean 6, standard deviation 3.46 of one.
    assert np.mean(distances) == pytest.approx(6, abs=4 * 3.46 / np.sqrt(60))


def test_the_cameras_own_error_is_in_the_covariance():
    """Planes fitted with cameras drawn from their covariance scatter as the joint covariance says."""
    sigma = np.array([2.0, 2.0, 3.0, 3.0, 0, 4e-3, 8e-3, 3e-4, 3e-4, 4e-3])
    known = KnownCamera(CAMERA, np.diag(sigma**2))
    rng = np.random.default_rng(4)
    view = seen(CAMERA, POSE, lying(), noise_px=0)
    fit = fit_plane(known, [view], BOARD, lying())
    steps, cameras = [], []
    for _ in range(150):
        drawn = CAMERA.parameters + rng.normal(size=10) * sigma
        other = fit_plane(
            KnownCamera.exact(CAMERA.with_parameters(drawn)), [view], BOARD, lying(), robust=False
        )
        steps.append(pose_difference(fit.plane.cam_from_station, other.plane.cam_from_station))
        cameras.append(drawn - CAMERA.parameters)
    found = np.cov(np.hstack([cameras, steps]).T)
    stated = fit.plane.covariance
    free = np.flatnonzero(np.diag(stated) > 0)
    ratio = np.sqrt(np.diag(found)[free] / np.diag(stated)[free])
    assert np.abs(ratio - 1).max() < 0.25
    size = np.sqrt(np.outer(np.diag(stated), np.diag(stated)))[np.ix_(free, free)]
    assert np.abs((found - stated)[np.ix_(free, free)] / size).max() < 0.35


def test_boards_elsewhere_on_the_table_tell_the_plane_better():
    shifted = [lying(), lying(0.05, 0.2, 0.5), lying(-0.2, -0.05, 2.0)]
    views = [seen(CAMERA, POSE, place, seed=i, name=f"{i}.png") for i, place in enumerate(shifted)]
    one, three = (fit_plane(EXACT, some, BOARD, lying()) for some in (views[:1], views))
    assert [level.image for level in three.levels] == ["1.png", "2.png"]
    assert all(abs(level.height_m) < 4 * level.sigma_height_m for level in three.levels)
    assert all(level.sigma_height_m < 0.002 for level in three.levels)
    far = CAMERA.project(POSE.apply(np.array([[0.15, -0.15, 0.0]])))
    single, several = (np.trace(fit.plane.measure(far)[1][0]) for fit in (one, three))
    assert several < 0.5 * single
    step = pose_difference(three.plane.cam_from_station, POSE)
    assert mahalanobis(step, three.plane.pose_covariance) < 22.5


def test_the_same_board_photographed_again_counts_as_more_of_the_same():
    views = [seen(CAMERA, POSE, lying(), seed=i, name=f"{i}.png") for i in range(4)]
    four = fit_plane(EXACT, views, BOARD, lying())
    assert four.levels == ()
    one = fit_plane(EXACT, views[:1], BOARD, lying())
    ratio = np.diag(one.plane.pose_covariance) / np.diag(four.plane.pose_covariance)
    assert np.median(ratio) == pytest.approx(4, rel=0.5)


def test_a_board_on_a_box_is_refused():
    views = [
        seen(CAMERA, POSE, lying(), name="flat.png"),
        seen(CAMERA, POSE, lying(0.1, 0.1, 0.3, 0.02), name="box.png"),
    ]
    with pytest.raises(UnlevelBoard, match=r"box.png does not lie on .*\+(19|20)\.\d mm off") as caught:
        fit_plane(EXACT, views, BOARD, lying())
    assert caught.value.height_mm == pytest.approx(20, abs=1)


def test_outliers_are_named():
    view = seen(CAMERA, POSE, lying())
    pixels = view.pixels.copy()
    pixels[7] += [15, -9]
    pixels[31] += [0, 4]
    fit = fit_plane(EXACT, [Corners("a.png", view.ids, pixels)], BOARD, lying())
    assert {one.corner for one in fit.rejected} == {7, 31}
    assert fit.noise_px == pytest.approx(0.1, rel=0.2)


def test_known_noise_scales_the_covariance():
    view = seen(CAMERA, POSE, lying())
    one, two = (
        fit_plane(EXACT, [view], BOARD, lying(), sigma_px=s).plane.pose_covariance for s in (0.1, 0.2)
    )
    assert np.allclose(4 * one, two, rtol=1e-9)


def test_edge_on_is_refused():
    with pytest.raises(EdgeOnPlane, match=r"edge-on \(line of sight 2\.\d degrees"):
        fit_plane(EXACT, [seen(CAMERA, looking_down(2.0), lying(-0.1, 0.06), noise_px=0.02)], BOARD, lying())


def test_a_far_small_board_has_two_tilts():
    """At six metres the board spans 30 px: with half a pixel of noise its mirrored tilt fits as well."""
    far = looking_down(50, 6.0)
    with pytest.raises(AmbiguousPlane, match="does not tell which of two tilts"):
        fit_plane(EXACT, [seen(CAMERA, far, lying(), noise_px=0.5, seed=1)], BOARD, lying())


def test_a_near_board_has_a_rival_that_is_far_worse():
    fit = fit_plane(EXACT, [seen(CAMERA, POSE, lying())], BOARD, lying())
    assert fit.rival is None or fit.rival_gap > 30


def test_straight_down_is_no_ambiguity():
    """The mirrored tilt of a board seen face-on is nearly the same tilt: one broad minimum, honest sigma."""
    down = looking_down(89.0, 0.7)
    for seed in range(20):
        fit = fit_plane(EXACT, [seen(CAMERA, down, lying(), seed=seed)], BOARD, lying())
        step = pose_difference(fit.plane.cam_from_station, down)
        assert mahalanobis(step, fit.plane.pose_covariance) < 30


def test_too_few_points_and_points_on_a_line_are_refused():
    view = seen(CAMERA, POSE, lying())
    with pytest.raises(BadParameter, match="at least 4"):
        fit_plane(EXACT, [Corners("a.png", view.ids[:3], view.pixels[:3])], BOARD)
    with pytest.raises(BadParameter, match="on one line"):
        fit_plane(EXACT, [Corners("a.png", view.ids[:9], view.pixels[:9])], BOARD)
    with pytest.raises(BadParameter, match="one or more"):
        fit_plane(EXACT, [], BOARD)


def test_marked_points_serve_as_well():
    """Five points with known X, Y, seen by a camera level with nothing: the same truth."""
    marks = np.array([[0, 0, 0], [0.2, 0, 0], [0.2, 0.15, 0], [0, 0.15, 0], [0.1, 0.05, 0.0]])
    pixels = CAMERA.project(POSE.apply(marks))
    fit = fit_plane(EXACT, [Corners("points.csv", np.arange(5), pixels)], marks, SE3.identity(), sigma_px=0.5)
    assert np.abs(pose_difference(POSE, fit.plane.cam_from_station)).max() < 1e-9
    assert fit.noise_px == pytest.approx(0.5)
