"""The laws on exact geometry: they converge from wherever a knock leaves them, and lost sight has its end."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vision_robot.errors import BadParameter, LostSight, ServoAstray
from vision_robot.geometry import SE3, WorkPlane
from vision_robot.pick.closed_loop import LAWS
from vision_robot.pick.servo.kinematic import KinematicStage
from vision_robot.pick.servo.settings import Servoing
from vision_robot.pick.sighting import Sighting
from vision_robot.pick.world import ordinary_world

VIEW = ordinary_world().view
BELIEVED = WorkPlane.exact(VIEW.camera, VIEW.cam_from_station)
HEIGHT_M = 0.005
HOW = Servoing()
THREE = st.tuples(*3 * [st.floats(-1.0, 1.0)])


def knocked(turn_deg, shift_mm):
    """The plane before a camera that was turned and shifted after it was calibrated."""
    knock = SE3.from_rotvec(np.radians(turn_deg), 1e-3 * np.asarray(shift_mm, dtype=float))
    return WorkPlane.exact(VIEW.camera, knock @ VIEW.cam_from_station)


def sighted(true, place_m):
    """What the believed camera says of a thing that lies at `place_m`, and where it really is."""
    pixel = true.pixels(np.array(place_m)[None], z_m=HEIGHT_M)
    seen, _ = BELIEVED.measure(pixel, z_m=HEIGHT_M)
    return Sighting(seen[0], np.zeros((2, 2)), 0.3, HEIGHT_M)


def off_m(place, place_m):
    return float(np.linalg.norm(place.position_m - place_m))


KNOCK = knocked([0.6, 0.8, -0.5], [3, -4, 2])
PLACE = (0.03, -0.06)


@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=15)
@given(THREE, THREE, st.floats(-0.1, 0.08), st.floats(-0.1, 0.1))
def test_every_law_finds_the_thing_within_the_capture_range(law, turn, shift, x, y):
    """Up to 2 degrees and 20 mm on each axis, without noise: to a thirtieth of what open loop misses by."""
    true = knocked(2 * np.array(turn), 20 * np.array(shift))
    first = sighted(true, (x, y))
    stage = KinematicStage(BELIEVED, true, np.array([x, y]), noise_px=0.0)
    found = LAWS[law](stage, first, HOW)
    assert off_m(found, (x, y)) <= 1e-4 + off_m(first, (x, y)) / 30


@pytest.mark.parametrize("law", LAWS)
def test_without_a_knock_nothing_is_mended(law):
    stage = KinematicStage(BELIEVED, BELIEVED, np.array(PLACE), noise_px=0.0)
    assert off_m(LAWS[law](stage, sighted(BELIEVED, PLACE), HOW), PLACE) < 1e-7


def test_look_move_look_says_how_well_it_knows():
    """What it states is what it errs: squared errors over stated variances are about one."""
    first, ratios = sighted(KNOCK, PLACE), []
    for seed in range(40):
        stage = KinematicStage(BELIEVED, KNOCK, np.array(PLACE), seed=seed)
        found = LAWS["look-move-look"](stage, first, HOW)
        error = found.position_m - PLACE
        ratios.append(error @ np.linalg.solve(found.covariance_m2, error) / 2)
        assert stage.looks[-1].sigma_m <= HOW.stop_m
        assert 2 <= len(stage.looks) <= 5
    assert 0.5 < np.mean(ratios) < 1.6


def test_look_move_look_needs_fewer_looks_than_frames_of_the_others():
    counts = {}
    for law in LAWS:
        stage = KinematicStage(BELIEVED, KNOCK, np.array(PLACE))
        LAWS[law](stage, sighted(KNOCK, PLACE), HOW)
        counts[law] = len(stage.looks)
    assert counts["look-move-look"] < 0.2 * min(counts["position"], counts["image"])


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("lost", ["predict", "hold"])
def test_pictures_lost_now_and_then_are_got_over(law, lost):
    stage = KinematicStage(BELIEVED, KNOCK, np.array(PLACE), lost_sight=0.3, seed=1, noise_px=0.02)
    found = LAWS[law](stage, sighted(KNOCK, PLACE), replace(HOW, lost=lost))
    assert off_m(found, PLACE) < 5e-4


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("lost", ["predict", "hold", "abort"])
def test_lost_sight_ends_with_the_reason(law, lost):
    stage = KinematicStage(BELIEVED, KNOCK, np.array(PLACE), dark_from_s=0.2 * (law != "look-move-look"))
    with pytest.raises(LostSight, match="label on the hand was out of sight for") as caught:
        LAWS[law](stage, sighted(KNOCK, PLACE), replace(HOW, lost=lost))
    patience = 0.0 if lost == "abort" else HOW.patience_s
    assert caught.value.seconds == pytest.approx(patience, abs=0.1)


def test_sight_that_is_lost_when_enough_is_known_is_no_reason_to_stop():
    how = replace(HOW, most_looks=8, stop_m=1e-9)
    stage = KinematicStage(BELIEVED, KNOCK, np.array(PLACE), dark_from_s=0.05, latency_s=0.01)
    assert off_m(LAWS["look-move-look"](stage, sighted(KNOCK, PLACE), how), PLACE) < 1e-3


def test_latency_costs_stability_only_where_it_is_not_compensated():
    how = replace(HOW, gain_per_s=10.0)

    def slow() -> KinematicStage:
        return KinematicStage(BELIEVED, KNOCK, np.array(PLACE), latency_s=0.3, noise_px=0.02)

    mended = LAWS["position"](slow(), sighted(KNOCK, PLACE), how)
    assert off_m(mended, PLACE) < 5e-4
    with pytest.raises(ServoAstray, match="position loop did not settle in 6 s"):
        LAWS["position"](slow(), sighted(KNOCK, PLACE), replace(how, compensate=False))


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("lost", "pray", "predict, hold, abort"),
        ("heights_m", (), "above 0"),
        ("gain_per_s", 0.0, "positive"),
        ("most_looks", 0, "at least one"),
    ],
)
def test_settings_that_cannot_be_are_refused(name, value, said):
    with pytest.raises(BadParameter, match=said):
        replace(HOW, **{name: value})
