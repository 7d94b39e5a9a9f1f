"""The descent reaches the least-squares minimum, from near and far, at OpenCV's rms or below."""

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate.normal_equations import normal_equations
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.problem import Problem
from vision_robot.calibrate.refine import arrow_solve, refine, schur_complement
from vision_robot.calibrate.state import State
from vision_robot.calibrate.warp import Warp
from vision_robot.errors import NoConvergence

FLAT = Warp.none(88)
FREE = np.array([1, 1, 1, 1, 0, 1, 1, 1, 1, 1], bool)


def problem(seed=0, count=8, noise_px=0.2):
    views = make_views(CAMERAS["brown5"], count, seed=seed, noise_px=noise_px)
    return views, Observations.of(views.corners, views.board)


def dense(equations):
    p, views = len(equations.shared), len(equations.pose)
    H = np.zeros((p + 6 * views, p + 6 * views))
    H[:p, :p] = equations.shared
    for i in range(views):
        own = slice(p + 6 * i, p + 6 * i + 6)
        H[:p, own], H[own, :p], H[own, own] = equations.border[i], equations.border[i].T, equations.pose[i]
    return H, np.concatenate([equations.shared_gradient, equations.pose_gradient.ravel()])


def test_the_arrow_is_solved_as_the_whole_matrix_would_be():
    views, seen = problem()
    equations = normal_equations(State(views.camera, views.cam_from_board, FLAT), Problem.plain(seen, FREE))
    H, g = dense(equations)
    scale = 1 / np.sqrt(np.diag(H))
    whole = -scale * np.linalg.solve(H * scale[:, None] * scale, scale * g)
    shared, pose = arrow_solve(equations)
    np.testing.assert_allclose(
        np.concatenate([shared, pose.ravel()]) / scale, whole / scale, rtol=1e-6, atol=1e-9
    )
    inverse = np.linalg.inv(schur_complement(equations))
    np.testing.assert_allclose(inverse, np.linalg.inv(H)[: FREE.sum(), : FREE.sum()], rtol=1e-5)


def test_without_noise_the_truth_comes_back():
    views, seen = problem(noise_px=0.0)
    start = views.camera.with_parameters(views.camera.parameters * 1.02)
    end = refine(State(start, views.cam_from_board, FLAT), Problem.plain(seen, FREE))
    np.testing.assert_allclose(end.state.camera.parameters, views.camera.parameters, rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("factor", [0.7, 1.0, 1.4])
def test_the_minimum_does_not_depend_on_the_start(factor):
    views, seen = problem(1)
    parameters = views.camera.parameters
    parameters[:2] *= factor
    parameters[5:] = 0
    end = refine(
        State(views.camera.with_parameters(parameters), views.cam_from_board, FLAT), Problem.plain(seen, FREE)
    )
    near = refine(State(views.camera, views.cam_from_board, FLAT), Problem.plain(seen, FREE))
    assert end.equations.cost == pytest.approx(near.equations.cost, rel=1e-9)
    np.testing.assert_allclose(end.state.camera.parameters[:4], near.state.camera.parameters[:4], atol=1e-3)


def test_fixed_parameters_stay():
    views, seen = problem(2)
    free = FREE.copy()
    free[9] = False
    end = refine(State(views.camera, views.cam_from_board, FLAT), Problem.plain(seen, free))
    assert end.state.camera.distortion[4] == views.camera.distortion[4]


def test_no_result_is_made_up_when_iterations_run_out():
    views, seen = problem(3)
    start = views.camera.with_parameters(views.camera.parameters * 1.3)
    with pytest.raises(NoConvergence):
        refine(State(start, views.cam_from_board, FLAT), Problem.plain(seen, FREE), max_iterations=2)


@pytest.mark.parametrize("count", [5, 30])
def test_rms_is_not_above_opencv(count):
    import cv2

    views, seen = problem(4, count)
    end = refine(State(views.camera, views.cam_from_board, FLAT), Problem.plain(seen, FREE))
    board = [views.board.astype(np.float32)] * count
    pixels = [view.pixels.astype(np.float32) for view in views.corners]
    theirs = cv2.calibrateCamera(board, pixels, (1280, 960), None, None)[0]  # pyright: ignore
    ours = np.sqrt(2 * end.equations.cost / seen.ids.size)
    assert ours <= theirs + 1e-6
