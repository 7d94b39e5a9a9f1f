"""Margins by eigenvalues are those of the closed form, and those of the loop when it is run."""

import numpy as np
import pytest

from vision_robot.errors import LostSight, ServoAstray
from vision_robot.geometry import SE3, WorkPlane
from vision_robot.pick.servo.continuous import position_based
from vision_robot.pick.servo.kinematic import KinematicStage
from vision_robot.pick.servo.margins import critical_gain_per_s, critical_latency_s, growth, mismatch
from vision_robot.pick.servo.settings import Servoing
from vision_robot.pick.sighting import Sighting
from vision_robot.pick.world import ordinary_world

VIEW = ordinary_world().view
PLANE = WorkPlane.exact(VIEW.camera, VIEW.cam_from_station)
PERIOD = 1 / 30


@pytest.mark.parametrize("delay", [1, 2, 3, 6])
def test_a_delayed_integrator_bears_what_the_closed_form_says(delay):
    """z^(d+1) - z^d + g = 0 leaves the unit circle at g = 2 sin(pi / (2 (2 d + 1)))."""
    found = critical_gain_per_s(delay * PERIOD, PERIOD, compensate=False) * PERIOD
    assert found == pytest.approx(2 * np.sin(np.pi / (2 * (2 * delay + 1))), rel=1e-6)


def test_what_is_known_exactly_is_compensated_for_any_latency():
    assert critical_gain_per_s(0.5, PERIOD) == np.inf
    assert growth(0.3, 10) == pytest.approx(0.7)
    assert critical_latency_s(10.0, PERIOD) == np.inf
    assert critical_latency_s(10.0, PERIOD, compensate=False) < 0.2


def test_lag_and_a_wrong_jacobian_cost_margin():
    exact = critical_gain_per_s(0.1, PERIOD, compensate=False)
    assert critical_gain_per_s(0.1, PERIOD, compensate=False, lag_s=0.05) < exact
    assert critical_gain_per_s(0.1, PERIOD, 1.3, compensate=False) == pytest.approx(exact / 1.3)
    assert critical_gain_per_s(0.1, PERIOD, np.exp(0.5j), compensate=False) < exact


def test_a_camera_turned_about_its_axis_turns_the_error():
    """The eigenvalue of a turn by t is exp(it); of a focal length too large by a share, its inverse."""
    point = np.array([0.0, 0.0, 0.0])
    turned = WorkPlane.exact(
        VIEW.camera, SE3.from_rotvec(np.array([0, 0, 0.3]), np.zeros(3)) @ PLANE.cam_from_station
    )
    assert abs(np.angle(mismatch(PLANE, turned, point))) == pytest.approx(0.3, abs=0.03)
    assert mismatch(PLANE, PLANE, point) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize(("share", "calm"), [(0.75, True), (1.2, False)])
def test_the_loop_itself_swings_up_where_it_is_said(share, calm):
    latency = 0.1
    gain = share * critical_gain_per_s(latency, PERIOD, compensate=False)
    how = Servoing(gain_per_s=gain, compensate=False, heights_m=(0.02,), enough_m=1.0)
    stage = KinematicStage(PLANE, PLANE, np.zeros(2), latency_s=latency, noise_px=0.01)
    first = Sighting(np.array([0.002, 0.0]), np.zeros((2, 2)), 0.0, 0.005)
    # What it steers at is the place that was seen; it starts 2 mm beside it.
    off = WorkPlane.exact(VIEW.camera, SE3(np.eye(3), np.array([0.002, 0.0, 0.0])) @ VIEW.cam_from_station)
    stage.true_plane = off
    if calm:
        position_based(stage, first, how)
        assert stage.looks[-1].error_m < 1e-3
    else:
        with pytest.raises((ServoAstray, LostSight)):
            position_based(stage, first, how)
        assert stage.looks[-1].error_m > 2e-3
