"""`judge`: every question is answered where the views carry an answer, and named where they do not."""

import pytest

from tests.views import CAMERAS, make_views
from vision_robot.calibrate import Settings, calibrate
from vision_robot.calibrate.judgement import judge

SIZE = (1280, 960)


def test_a_sound_calibration_is_believed():
    views = make_views(CAMERAS["brown5"], 15, seed=1)
    judgement = judge(calibrate(views.corners, views.board, SIZE), views.board)
    assert judgement.unanswered == {}
    assert judgement.held_out is not None
    assert judgement.held_out.rms_px == pytest.approx(0.2 * 2**0.5, rel=0.1)
    assert judgement.halves is not None
    assert judgement.bootstrap is not None
    assert judgement.halves.honest
    assert judgement.bootstrap.honest
    assert judgement.error_budget is not None
    assert judgement.error_budget.dominant.cause == "corner noise"
    assert judgement.next_views is not None
    assert (judgement.next_views.together_px < judgement.next_views.sigma_px).all()


def test_a_lens_too_simple_is_not_believed():
    views = make_views(CAMERAS["brown5"], 20, seed=2)
    judgement = judge(
        calibrate(views.corners, views.board, SIZE, Settings(model="pinhole", robust=False)), views.board
    )
    assert judgement.bootstrap is not None
    assert not judgement.bootstrap.honest
    assert judgement.error_budget is not None
    assert judgement.error_budget.dominant.cause in ("lens model", "rest")


def test_questions_that_three_views_cannot_answer_are_named():
    views = make_views(CAMERAS["pinhole"], 3, seed=3)
    judgement = judge(calibrate(views.corners, views.board, SIZE, Settings(model="pinhole")), views.board)
    assert judgement.held_out is None
    assert judgement.halves is None
    assert {"held out", "halves"} <= set(judgement.unanswered)
    assert judgement.error_budget is not None
