"""An arm built otherwise than drawn: its links come out of the views, and with them the camera's place."""

import numpy as np
import pytest

from vision_robot.calibrate.hand_eye import ArmNoise, GeometryTolerance, HandEyeSettings, calibrate_hand_eye
from vision_robot.calibrate.hand_eye.judgement import judge_hand_eye
from vision_robot_synth.hand_eye import hand_eye_set

LINKS = (float(np.radians(0.3)), 1e-3)
REPEATS = ArmNoise(float(np.radians(0.002)), 0.02e-3)


@pytest.mark.parametrize("arm", ["column", "six-axis"])
def test_links_off_by_a_millimetre(arm):
    made = hand_eye_set(arm=arm, views=20, noise=REPEATS, link_errors=LINKS, seed=2)
    fresh = hand_eye_set(arm=arm, views=12, noise=REPEATS, link_errors=LINKS, seed=2).joints[::-1]
    fresh = np.clip(fresh + 0.05, *made.cell.arm.limits.T)
    true = (
        made.cell.far_from_board.inverse() @ made.true_arm.base_from_wrist(fresh) @ made.cell.mount_from_cam
    )
    off, noise = {}, {}
    for name, tolerance in (("drawn", None), ("found", GeometryTolerance())):
        result = calibrate_hand_eye(
            made.corners(0.2), made.said, made.board.points, made.camera, HandEyeSettings(geometry=tolerance),
            arm=made.cell.arm, joints=made.joints,
        )  # fmt: skip
        chain = result.geometry.chain if result.geometry else made.cell.arm
        camera = result.far_from_board.inverse() @ chain.base_from_wrist(fresh) @ result.mount_from_cam
        off[name] = np.median(np.linalg.norm(camera.translation - true.translation, axis=1))
        noise[name] = result.noise.noise.shift_m
    assert off["drawn"] > 1.5e-3
    assert off["found"] < 0.4e-3
    assert noise["found"] < 0.1e-3 < noise["drawn"]


def test_what_the_views_do_not_tell_of_the_links_is_said():
    made = hand_eye_set(views=4, noise=REPEATS, link_errors=LINKS, seed=1)
    result = calibrate_hand_eye(
        made.corners(0.2), made.said, made.board.points, made.camera,
        HandEyeSettings(geometry=GeometryTolerance()), arm=made.cell.arm, joints=made.joints,
    )  # fmt: skip
    said = " ".join(judge_hand_eye(result).advice)
    assert "combinations of link errors" in said
