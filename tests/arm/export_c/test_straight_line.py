"""Every operation that CasADi may write comes out as C that computes the same."""

import ctypes
import subprocess

import casadi as ca
import numpy as np
import pytest

from tests.arm.compiled import STRICT, needs_gcc
from vision_robot.arm.export_c.precision import DOUBLE, SINGLE
from vision_robot.arm.export_c.straight_line import straight_line
from vision_robot.errors import BadParameter

HEAD = "#include <math.h>\ntypedef {0} vr_real;\n"
CALL = """
void call(const vr_real *x, const vr_real *y, vr_real *out, vr_real *zeros);
void call(const vr_real *x, const vr_real *y, vr_real *out, vr_real *zeros) { f(x, y, out, zeros); }
"""

x, y = ca.SX.sym("x", 3), ca.SX.sym("y", 2)
a, b, c = x[0], x[1], y[0]
EXPRESSIONS = {
    "arithmetic": a * b - c / (a + 4) + -b,
    "negative constants": -2.5 * a - (-3) + (b - (-0.125)),
    "powers": ca.sqrt(a * a + b * b) + ca.power(ca.fabs(a) + 0.5, 1.5) + 1 / (c + 3) + 2 * a + a * a,
    "angles": ca.sin(a)
    + ca.cos(b)
    + ca.tan(c)
    + ca.atan2(a, b)
    + ca.atan(c)
    + ca.asin(a / 9)
    + ca.acos(b / 9),
    "roots of many": ca.hypot(a, b) + ca.exp(a / 4) + ca.log(ca.fabs(b) + 1),
    "steps": ca.floor(a) + ca.ceil(b) + ca.sign(c) + ca.fmod(a, 0.7) + ca.copysign(a, b),
    "choices": ca.if_else(a < b, ca.sin(c), a)
    + ca.fmin(a, c)
    + ca.fmax(b, c)
    + ca.if_else(ca.logic_not(a <= c), 1, 2),
    "logic": ca.if_else(ca.logic_and(a > 0, b > 0), 3, 5)
    + ca.if_else(ca.logic_or(a > 0, ca.ne(b, c)), 7, 11),
    "a constant": ca.SX(0.1),
    "shared parts": ca.sin(a + b) * ca.sin(a + b) + ca.sin(a + b),
}


@needs_gcc
@pytest.mark.parametrize("precision", [SINGLE, DOUBLE], ids=lambda p: p.name)
def test_c_computes_what_casadi_does(tmp_path, precision):
    function = ca.Function("f", [x, y], [ca.vertcat(*EXPRESSIONS.values()), ca.SX(2, 2)])
    written = straight_line(function, "f", ["x", "y"], ["out", "zeros"], precision)
    source = tmp_path / "f.c"
    source.write_text(HEAD.format(precision.c_type) + written.code + CALL)
    library = tmp_path / "f.so"
    subprocess.run(["gcc", *STRICT, "-shared", "-fPIC", str(source), "-o", str(library), "-lm"], check=True)
    real = ctypes.c_float if precision is SINGLE else ctypes.c_double
    rng = np.random.default_rng(4)
    for _ in range(200):
        values = [rng.uniform(-3, 3, 3), rng.uniform(-3, 3, 2)]
        out, zeros = (real * len(EXPRESSIONS))(), (real * 4)(*[9.0] * 4)
        given = [(real * len(v))(*v) for v in values]
        ctypes.CDLL(str(library)).call(*given, out, zeros)
        right = np.asarray(function(*[np.array(g[:]) for g in given])[0]).ravel()
        assert np.allclose(
            out[:],
            right,
            rtol=2e-5 if precision is SINGLE else 1e-13,
            atol=1e-5 if precision is SINGLE else 1e-13,
        )
        assert zeros[:] == [0.0] * 4


def test_results_are_computed_once_and_outputs_last():
    function = ca.Function("f", [x], [ca.vertcat(ca.sin(x[0]) + 1, ca.sin(x[0]) + 2)])
    written = straight_line(function, "f", ["x"], ["out"], SINGLE)
    assert written.code.count("sinf") == 1 == written.operations["sin"]
    assert written.functions == {"sin"}
    assert written.operations["add"] == 2
    lines = written.code.splitlines()
    assert [line.startswith("    out[") for line in lines[2:-1]] == [False] * 3 + [True] * 2


def test_single_precision_has_no_double_constant():
    function = ca.Function("f", [x], [0.1 * x + 1e-9])
    assert "0.1f" in (text := straight_line(function, "f", ["x"], ["out"], SINGLE).code)
    assert "1e-09f" in text
    assert "0.1 " in straight_line(function, "f", ["x"], ["out"], DOUBLE).code


def test_an_operation_without_c_is_named():
    function = ca.Function("f", [x], [ca.erf(x[0])])
    with pytest.raises(BadParameter, match="'erf'"):
        straight_line(function, "f", ["x"], ["out"], SINGLE)
