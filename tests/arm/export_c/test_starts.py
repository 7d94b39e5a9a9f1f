"""The chosen starts reach all that is asked, and the rehearsal in numpy is what the C does."""

import ctypes
from dataclasses import replace

import numpy as np

from tests.arm.compiled import goals_inside, needs_gcc
from vision_robot.arm import Task
from vision_robot.arm.export_c.starts import covering_starts, golden_steps, spread_points
from vision_robot.arm.model import read_arm


def test_few_starts_reach_what_is_drawn_inside_the_limits():
    chain = read_arm("column").chain
    starts = covering_starts(chain, Task.TILT, goals=400)
    assert len(starts.q) < 12
    assert chain.within_limits(starts.q).all()
    assert starts.reached >= 392
    assert 2 < starts.steps_mean < 60
    again = covering_starts(chain, Task.TILT, goals=400)
    assert (again.q == starts.q).all()


def test_spread_points_fill_the_joint_ranges():
    chain = read_arm("column").chain
    points = spread_points(chain, 512)
    assert chain.within_limits(points).all()
    share = (points - chain.limits[:, 0]) / np.diff(chain.limits)[:, 0]
    for column in share.T:
        assert np.histogram(column, bins=8, range=(0, 1))[0].min() > 512 / 8 * 0.9


def test_golden_ratio_in_one_dimension():
    assert golden_steps(1)[0] == round(2**32 * (np.sqrt(5) - 1) / 2)


@needs_gcc
def test_c_reaches_what_the_rehearsal_promised(compiled):
    arm = compiled("numeric", "double")
    starts = arm.export.starts
    assert starts.reached / starts.goals > 0.99
    q, goals = goals_inside(arm.arm, 300, seed=8)
    assert arm.solve_many(goals, np.roll(q, 1, axis=0))[0].all()


def test_limits_of_single_precision_are_never_wider():
    from vision_robot.arm.export_c.kernels import representable
    from vision_robot.arm.export_c.precision import SINGLE

    chain = read_arm("column").chain
    odd = replace(chain, limits=chain.limits + np.array([1e-9, -1e-9]))
    rounded = representable(odd, SINGLE).limits
    assert (rounded[:, 0] >= odd.limits[:, 0]).all()
    assert (rounded[:, 1] <= odd.limits[:, 1]).all()
    assert np.abs(rounded - odd.limits).max() < 1e-6
    assert all(ctypes.c_float(value).value == value for value in rounded.ravel())
