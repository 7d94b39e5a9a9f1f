"""The normal equations are what the definition says: J^T J and J^T r of the reprojection error."""

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate.normal_equations import normal_equations, residuals
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import Warp
from vision_robot.geometry import SE3, rotation_exp

FLAT = Warp.none(88)


def moved(camera, poses, free, step):
    p = int(free.sum())
    parameters = camera.parameters
    parameters[free] += step[:p]
    pose_step = step[p:].reshape(-1, 6)
    rotation = rotation_exp(pose_step[:, :3]) @ poses.rotation
    return camera.with_parameters(parameters), SE3(rotation, poses.translation + pose_step[:, 3:])


@pytest.mark.parametrize("model", CAMERAS)
@pytest.mark.parametrize("skew", [False, True])
def test_against_a_numeric_jacobian(model, skew):
    views = make_views(CAMERAS[model], 3, seed=1)
    camera = views.camera.with_parameters(
        views.camera.parameters + ([0] * 4 + [0.7] + [0] * (len(views.camera.parameters) - 5))
    )
    seen = Observations.of(views.corners, views.board)
    rng = np.random.default_rng(0)
    seen = seen.with_weight(seen.weight * rng.uniform(0.5, 2, seen.weight.shape))
    free = np.ones(len(camera.parameters), bool)
    free[4] = skew
    found = normal_equations(State(camera, views.cam_from_board, FLAT), Problem.plain(seen, free))

    def weighted(step):
        camera_, poses_ = moved(camera, views.cam_from_board, free, step)
        return (residuals(State(camera_, poses_, FLAT), seen) * seen.weight[:, None]).ravel()

    p, size = int(free.sum()), int(free.sum()) + 18
    scale = np.concatenate([np.abs(camera.parameters[free]) * 1e-5 + 1e-7, np.full(18, 1e-6)])
    J = np.stack(
        [(weighted(d) - weighted(-d)) / (2 * h) for d, h in zip(np.diag(scale), scale, strict=True)], axis=-1
    )
    H, g, r = J.T @ J, J.T @ weighted(np.zeros(size)), weighted(np.zeros(size))
    unit = 1 / np.sqrt(np.diag(H))

    def close(found_block, rows, columns):
        both = unit[rows][:, None] * unit[columns]
        np.testing.assert_allclose(found_block * both, H[rows][:, columns] * both, atol=2e-6)

    shared = np.arange(p)
    assert found.cost == pytest.approx(0.5 * r @ r)
    close(found.shared, shared, shared)
    for i in range(3):
        own = p + 6 * i + np.arange(6)
        close(found.border[i], shared, own)
        close(found.pose[i], own, own)
    np.testing.assert_allclose(found.shared_gradient * unit[:p], g[:p] * unit[:p], atol=1e-4)
    np.testing.assert_allclose(found.pose_gradient.ravel() * unit[p:], g[p:] * unit[p:], atol=1e-4)


def test_blocks_add_up_to_the_whole(monkeypatch):
    views = make_views(CAMERAS["brown5"], 7, seed=2)
    seen = Observations.of(views.corners, views.board)
    free = np.ones(10, bool)
    whole = normal_equations(State(views.camera, views.cam_from_board, FLAT), Problem.plain(seen, free))
    monkeypatch.setattr("vision_robot.calibrate.normal_equations.BLOCK_POINTS", 200)
    parts = normal_equations(State(views.camera, views.cam_from_board, FLAT), Problem.plain(seen, free))
    np.testing.assert_allclose(parts.shared, whole.shared, rtol=1e-12)
    np.testing.assert_allclose(parts.pose, whole.pose, rtol=1e-12)


def test_partial_views_count_only_what_they_show():
    views = make_views(CAMERAS["brown5"], 2, seed=3)
    full = Observations.of(views.corners, views.board)
    part = views.corners[1]
    half = type(part)(part.image, part.ids[::2], part.pixels[::2])
    partial = Observations.of([views.corners[0], half], views.board)
    error = residuals(State(views.camera, views.cam_from_board, FLAT), partial)
    expected = residuals(State(views.camera, views.cam_from_board, FLAT), full)[1][:, ::2]
    np.testing.assert_allclose(error[1][:, :44], expected)
    assert not error[1][:, 44:].any()


def test_a_board_behind_the_camera_costs_everything():
    views = make_views(CAMERAS["brown5"], 3, seed=4)
    seen = Observations.of(views.corners, views.board)
    behind = SE3(views.cam_from_board.rotation, -views.cam_from_board.translation)
    assert (
        normal_equations(State(views.camera, behind, FLAT), Problem.plain(seen, np.ones(10, bool))).cost
        == np.inf
    )
