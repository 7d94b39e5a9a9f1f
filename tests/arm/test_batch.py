"""All cores give one core's answers, in order."""

import numpy as np

from vision_robot.arm import batch, read_arm
from vision_robot.arm.ik import InverseKinematics

ARM = read_arm("column")


def goals(count: int):
    q = np.random.default_rng(0).uniform(*ARM.chain.limits.T, size=(count, 5))
    return q, ARM.chain.base_from_tool(q)


def test_threads_or_one_core_the_same_answers():
    ik = InverseKinematics(ARM)
    q, asked = goals(4501)
    for near in (None, np.zeros(5), q + 0.01):
        alone = ik.solve(asked, near=near)
        shared = batch.solve_on_all_cores(ik, asked, near=near, workers=3)
        assert np.array_equal(alone.q, shared.q)
        assert np.array_equal(alone.converged, shared.converged)


def test_processes_over_numpy(monkeypatch):
    monkeypatch.setattr(batch, "WORTH_PROCESSES", 100)
    ik = InverseKinematics(ARM, compiled=False)
    _, asked = goals(300)
    shared = batch.solve_on_all_cores(ik, asked, workers=2)
    assert shared.converged.all()
    assert np.allclose(ik.solve(asked).q, shared.q, atol=1e-12)
