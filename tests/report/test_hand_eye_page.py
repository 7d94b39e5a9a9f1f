"""The page of a hand-eye calibration shows every part, for both set-ups, and nothing it cannot compare."""

import pytest

from tests.hand_eye_sets import posed
from vision_robot.calibrate.hand_eye import GeometryTolerance, HandEyeSettings, calibrate_hand_eye
from vision_robot.calibrate.hand_eye.judgement import judge_hand_eye
from vision_robot.report.hand_eye import hand_eye_page
from vision_robot.report.page import render_page
from vision_robot_synth.hand_eye import hand_eye_set


@pytest.mark.parametrize("setup", ["eye-in-hand", "eye-to-hand"])
def test_every_part_has_its_place(setup):
    made = posed(setup, 10, seed=1)
    result = calibrate_hand_eye(made.corners, made.said, made.board, made.camera, HandEyeSettings(setup))
    judgement = judge_hand_eye(result)
    page = hand_eye_page(
        result, judgement, truth=made.truth, driven=["4 views: sigma 1 mm"], command="vr x", seed=1
    )
    text = render_page(page)
    for title in (
        "Where the camera sits",
        "The cell",
        "Residuals",
        "Can it be believed",
        "Where the error comes from",
    ):
        assert title in text
    assert "Where to drive next" in text
    assert "How the arm drove" in text
    assert made.truth.mount_name in text
    assert "misses the truth by" in text
    assert text.count("<figure>") == 5
    assert text == render_page(hand_eye_page(
        result, judgement, truth=made.truth, driven=["4 views: sigma 1 mm"], command="vr x", seed=1
    ))  # fmt: skip


def test_corrected_links_are_listed_and_not_compared_with_the_truth():
    made = hand_eye_set(views=10, link_errors=(0.005, 1e-3), seed=3)
    settings = HandEyeSettings(geometry=GeometryTolerance())
    result = calibrate_hand_eye(
        made.corners(0.2), made.said, made.board.points, made.camera, settings,
        arm=made.cell.arm, joints=made.joints,
    )  # fmt: skip
    from vision_robot_cli.hand_eye_output import cell_truth

    page = hand_eye_page(result, judge_hand_eye(result), board=made.board, truth=cell_truth(made))
    titles = [section.title for section in page.sections]
    assert "The arm's links" in titles
    assert "misses the truth" not in page.summary
    assert "theta4" in render_page(page)
