"""The Cortex-M4F's own code, run under qemu-arm, answers 1000 goals as Python does."""

import subprocess

import numpy as np
import pytest

from tests.arm.compiled import column_arm, goals_inside
from vision_robot.arm.export_c import export_c
from vision_robot.arm.export_c.emulation import available, instructions_per_solve, solve_emulated

pytestmark = pytest.mark.skipif(
    not available(), reason="no arm-none-eabi-gcc, make or qemu-arm on this machine"
)

NEWLIB = {"exit", "memcpy", "memset"}


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    made = {}

    def of(method, precision):
        if (method, precision) not in made:
            folder = tmp_path_factory.mktemp("arm")
            made[method, precision] = export_c(column_arm(), folder, method=method, precision=precision)
        return made[method, precision]

    return of


@pytest.mark.parametrize(
    ("method", "precision", "targets"),
    [
        ("closed-form", "single", 1000),
        ("closed-form", "double", 200),
        ("numeric", "single", 1000),
        ("numeric", "double", 40),  # every operation is a call there
    ],
)
def test_goals_are_answered(exported, method, precision, targets):
    export, arm = exported(method, precision), column_arm()
    q, goals = goals_inside(arm, targets, seed=11)
    answers = solve_emulated(export.folder, goals, np.roll(q, 1, axis=0))
    assert answers.shape == (targets, 1 + 5 + 2)
    assert (answers[:, 0] == 1).all()
    joints = answers[:, 1:6]
    assert arm.chain.within_limits(joints).all()
    missed = np.linalg.norm(
        (arm.chain.base_from_tool(joints).inverse() @ arm.chain.base_from_tool(q)).translation, axis=1
    )
    assert missed.max() < (1e-9 if precision == "double" else 1e-5)


def test_the_self_test_passes_there(exported):
    folder = exported("closed-form", "single").folder
    done = subprocess.run(["make", "qemu"], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "self-test: 0 of 64 failed" in done.stdout


def test_single_precision_calls_no_double_arithmetic_and_no_heap(exported):
    for method in ("closed-form", "numeric"):
        folder = exported(method, "single").folder
        for name in ("vr_ik", "vr_link"):
            listing = subprocess.run(
                ["arm-none-eabi-nm", f"{name}.mcu.o"], cwd=folder, check=True, capture_output=True, text=True
            ).stdout
            wanted = {line.split()[-1] for line in listing.splitlines() if " U " in line}
            assert not [
                symbol
                for symbol in wanted
                if symbol.startswith("__aeabi_d") or symbol in ("malloc", "memcpy")
            ]


def test_the_cost_is_measured_and_the_estimate_of_cycles_is_of_its_size(exported):
    export = exported("closed-form", "single")
    assert export.cost.source == "arm-none-eabi-gcc"
    assert 4500 < export.cost.code < 7000
    assert export.cost.data == 0
    assert 200 < export.cost.stack < 700
    q, goals = goals_inside(column_arm(), 12, seed=1)
    instructions = instructions_per_solve(export.folder, goals, np.roll(q, 1, axis=0))
    assert 0.5 < instructions / export.cycles.usual < 1.0
