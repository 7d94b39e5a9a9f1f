"""Which link errors change a pose at all: the counts of kinematic theory, for five real kinds of arm."""

import numpy as np
import pytest

from tests.arm.arms import PANDA, PUMA_560, UR5E
from vision_robot.arm import read_arm
from vision_robot.calibrate.hand_eye.arm import ArmGeometry, GeometryTolerance


@pytest.mark.parametrize(
    ("chain", "hinges", "slides"),
    [(UR5E, 6, 0), (PUMA_560, 6, 0), (PANDA, 7, 0), (read_arm("column").chain, 4, 1)],
)
def test_there_are_4r_plus_2p_less_6(chain, hinges, slides):
    """4 R + 2 P + 6 parameters of a complete arm (Mooring et al. 1991) less 6 for each of its two ends."""
    arm = ArmGeometry.of(chain, np.zeros((1, len(chain))))
    assert arm.count == 4 * hinges + 2 * slides - 6


def test_before_any_data_links_have_their_tolerance():
    arm = ArmGeometry.of(UR5E, np.zeros((1, 6)), GeometryTolerance(1e-2, 1e-3))
    scaled = arm.basis / np.tile([1e-2] * 3 + [1e-3] * 3, 6)[:, None]
    assert np.allclose(scaled.T @ scaled, np.eye(arm.count))


def test_a_step_moves_the_arm_and_is_remembered():
    arm = ArmGeometry.of(UR5E, np.zeros((2, 6)))
    step = np.random.default_rng(0).normal(size=arm.count)
    moved = arm.moved(step)
    assert np.allclose(moved.values, step)
    assert not np.allclose(moved.base_from_wrist.translation, arm.base_from_wrist.translation)
    assert np.allclose(arm.link_errors, 0)
