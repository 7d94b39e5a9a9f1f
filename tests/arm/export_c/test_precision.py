"""Constants are written so that they read back as the same number of their type."""

import numpy as np
import pytest

from vision_robot.arm.export_c.precision import DOUBLE, SINGLE, precision_named
from vision_robot.errors import BadParameter


def test_constants_read_back():
    for value in np.random.default_rng(1).normal(size=200) * 10.0 ** np.arange(-100, 100):
        assert float(DOUBLE.literal(value)) == value
    for value in np.random.default_rng(1).normal(size=60) * 10.0 ** np.arange(-30, 30):
        text = SINGLE.literal(value)
        assert text.endswith("f")
        assert np.float32(text[:-1]) == np.float32(value)


@pytest.mark.parametrize(
    ("value", "text"), [(2.0, "2.0f"), (np.inf, "VR_INFINITY"), (-np.inf, "-VR_INFINITY"), (np.nan, "VR_NAN")]
)
def test_hand_written(value, text):
    assert SINGLE.literal(value) == text


def test_names():
    assert precision_named("double") is DOUBLE
    with pytest.raises(BadParameter, match="single or double"):
        precision_named("half")
