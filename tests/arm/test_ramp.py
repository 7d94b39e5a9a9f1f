"""The ramp is the fastest straight motion: the same as `timed` finds on its grid, within the limits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.arm.ramp import ramp
from vision_robot.arm.timing import timed

NAMES = ("d1", "theta2")
LIMITS = {"velocity": np.array([0.5, 2.0]), "acceleration": np.array([2.0, 8.0])}


@given(st.floats(-0.4, 0.4), st.floats(-3, 3))
def test_it_ends_where_it_should_within_the_limits(slide, turn):
    end = np.array([slide, turn])
    motion = ramp(NAMES, np.zeros(2), end, **LIMITS)
    assert np.allclose(motion.q[-1], end, atol=1e-12)
    assert np.allclose(motion.velocity[[0, -1]], 0)
    assert (np.abs(motion.velocity) <= LIMITS["velocity"] * (1 + 1e-9)).all()
    assert (np.abs(motion.acceleration) <= LIMITS["acceleration"] * (1 + 1e-9)).all()


@pytest.mark.parametrize("end", [(0.3, 0.1), (0.01, 0.0), (0.1, -2.5)])
def test_nothing_is_faster(end):
    q = np.stack([np.zeros(2), np.array(end)])
    assert ramp(NAMES, q[0], q[1], **LIMITS).seconds == pytest.approx(
        timed(NAMES, q, **LIMITS).seconds, rel=5e-3
    )


def test_standing_still_takes_no_time():
    assert ramp(NAMES, np.ones(2), np.ones(2), **LIMITS).seconds == 0
