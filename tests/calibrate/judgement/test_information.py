"""What each view tells: the parts make up the whole."""

import numpy as np
import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Settings, calibrate
from vision_robot.calibrate.judgement.information import view_information
from vision_robot.calibrate.judgement.solution import solution
from vision_robot.calibrate.normal_equations import normal_equations
from vision_robot.calibrate.refine import schur_complement


@pytest.mark.parametrize("warp", [0, 2])
def test_views_add_up_to_the_schur_complement_and_pull_in_balance(warp):
    views = make_views(CAMERAS["brown5"], 9, seed=1)
    result = calibrate(views.corners, views.board, (1280, 960), Settings(warp=warp))
    state, problem = solution(result, views.board)
    information, gradient = view_information(state, problem.seen, problem.free)
    whole = schur_complement(normal_equations(state, problem))
    scale = 1 / np.sqrt(np.diag(whole))
    np.testing.assert_allclose(
        information.sum(axis=0) * scale[:, None] * scale, whole * scale[:, None] * scale, atol=1e-9
    )
    # At the minimum the views' pulls cancel: the step that is left is a small part of a sigma.
    pull = gradient.sum(axis=0)
    assert pull @ np.linalg.solve(whole, pull) < (0.01 * result.noise_px) ** 2
    assert (np.linalg.eigvalsh(information * scale[:, None] * scale) > -1e-9).all()
