"""Estimates follow the operations; without a compiler they are all there is."""

from collections import Counter

from tests.arm.compiled import column_arm
from vision_robot.arm.export_c import cost, export_c
from vision_robot.arm.export_c.precision import DOUBLE, SINGLE

OPERATIONS = Counter(add=10, mul=5, div=2, sin=3)


def test_cycles_by_hand():
    assert cost.cycles(OPERATIONS, SINGLE) == 3 * 15 + 2 * 17 + 3 * 170
    assert cost.cycles(OPERATIONS, DOUBLE) == 110 * 17 + 3 * 3000


def test_without_a_compiler_the_size_is_an_estimate(tmp_path, monkeypatch):
    monkeypatch.setattr(cost, "COMPILER", "no-such-compiler")
    export = export_c(column_arm(), tmp_path)
    assert export.cost.source == "estimate"
    assert export.cost.stack is None
    assert 4000 < export.cost.code < 8000


def test_stack_is_summed_along_the_calls():
    listing = (
        "vr_ik.c:9:5:vr_solve\t120\tstatic\nvr_ik.c:7:5:vr_branches\t200\tstatic\n"
        "vr_ik.c:5:5:vr_forward\t56\tstatic\nvr_kernels.h:5:13:vr_kernel_error\t72\tstatic\n"
    )
    assert cost._stack(listing) == 120 + 200 + 72
