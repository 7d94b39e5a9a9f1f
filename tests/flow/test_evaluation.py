"""Proves the metrics of flow on cases worked by hand."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.flow import flow_error
from vision_robot.flow.evaluation import angular_error_deg, outliers


@pytest.mark.parametrize(
    ("flow", "truth", "endpoint", "angle"),
    [
        ((0, 0), (0, 0), 0, 0),
        ((1, 0), (0, 0), 1, 45),  # (1, 0, 1) against (0, 0, 1)
        ((1, 0), (-1, 0), 2, 90),  # (1, 0, 1)·(−1, 0, 1) = 0
        ((3, 4), (0, 0), 5, 78.6900675),  # atan 5
        ((1e8, 0), (-1e8, 0), 2e8, 180),
        ((1, 1e-9), (1, 0), 1e-9, np.degrees(1e-9 / np.sqrt(2))),
    ],
)
def test_by_hand(flow, truth, endpoint, angle):
    error = flow_error(np.array([[flow]], float), np.array([[truth]], float))
    assert error.endpoint_px == pytest.approx(endpoint, rel=1e-9)
    assert error.angular_deg == pytest.approx(angle, rel=1e-6)


def test_outliers_are_far_off_in_pixels_and_in_share():
    truth = np.array([[0.0, 0], [0, 0], [100, 0], [100, 0], [50, 0]])
    flow = np.array([[3.0, 0], [3.1, 0], [104, 0], [106, 0], [53.1, 0]])
    np.testing.assert_array_equal(outliers(flow, truth), [False, True, False, True, True])


def test_only_what_is_known_and_asked_for_counts():
    truth = np.zeros((2, 3, 2))
    truth[0, 0] = np.nan
    flow = np.zeros((2, 3, 2))
    flow[0, 0], flow[1, 2] = 99, (0, 2)
    mask = np.ones((2, 3), bool)
    mask[0, 1] = False
    error = flow_error(flow, truth, mask)
    assert error.pixels == 4
    assert error.endpoint_px == 0.5
    flow[0, 1] = np.nan
    assert flow_error(flow, truth, mask).pixels == 4
    with pytest.raises(BadParameter, match="not a number at 1 pixels"):
        flow_error(flow, truth)


def test_turning_both_changes_nothing():
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(2, 50, 2))
    c, s = np.cos(1.0), np.sin(1.0)
    turn = np.array([[c, -s], [s, c]])
    np.testing.assert_allclose(angular_error_deg(a @ turn.T, b @ turn.T), angular_error_deg(a, b))


def test_nothing_to_count_is_refused():
    with pytest.raises(BadParameter, match="at least one"):
        flow_error(np.zeros((2, 2, 2)), np.full((2, 2, 2), np.nan))
    with pytest.raises(BadParameter, match="shape"):
        flow_error(np.zeros((2, 2, 2)), np.zeros((2, 3, 2)))
