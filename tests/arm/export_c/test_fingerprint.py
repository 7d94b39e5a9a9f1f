"""The fingerprint tells arms and tools apart, and not rounding."""

from dataclasses import replace

import numpy as np

from tests.arm.arms import PUMA_560, UR5E
from tests.arm.compiled import column_arm
from vision_robot.arm.export_c import fingerprint
from vision_robot.geometry import SE3


def test_arms_differ():
    chain = column_arm().chain
    longer = replace(chain, wrist_from_tool=SE3(np.eye(3), np.array([0, 0, 0.1501])))
    tighter = replace(chain, limits=chain.limits * 0.99)
    renamed = replace(chain, joint_names=("a", *chain.joint_names[1:]))
    marks = {fingerprint(one) for one in (chain, longer, tighter, renamed, UR5E, PUMA_560)}
    assert len(marks) == 6
    assert all(0 <= mark < 2**32 for mark in marks)


def test_rounding_and_signs_of_zero_do_not_count():
    chain = column_arm().chain
    moved = replace(chain.wrist_from_tool, translation=chain.wrist_from_tool.translation + 1e-13)
    assert fingerprint(replace(chain, wrist_from_tool=moved, axes=chain.axes * 1.0 - 0.0)) == fingerprint(
        chain
    )
    assert fingerprint(replace(chain, limits=np.where(chain.limits == 0, -0.0, chain.limits))) == fingerprint(
        chain
    )
