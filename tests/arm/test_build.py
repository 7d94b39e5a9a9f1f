"""Compiled code: made once, kept by content, and done without where it cannot be."""

import os

import numpy as np
import pytest

from vision_robot.arm import Task, read_arm
from vision_robot.arm.build import cache_folder, find_compiler, load_library
from vision_robot.arm.compiled_engine import compiled_engine
from vision_robot.arm.engine import program_of
from vision_robot.arm.ik import InverseKinematics
from vision_robot.arm.numpy_engine import NumpyEngine
from vision_robot.arm.starts import windows
from vision_robot.errors import BadParameter

needs_compiler = pytest.mark.skipif(not find_compiler(), reason="no C compiler")


@needs_compiler
def test_the_same_source_is_compiled_once(tmp_path):
    source = "int answer(void) { return 42; }"
    library = load_library(source, tmp_path)
    assert library is not None
    assert library.answer() == 42
    (made,) = tmp_path.iterdir()
    before = made.stat().st_mtime_ns
    assert load_library(source, tmp_path) is not None
    assert [made.stat().st_mtime_ns] == [path.stat().st_mtime_ns for path in tmp_path.iterdir()] == [before]
    assert load_library(source + "\n", tmp_path) is not None
    assert len(list(tmp_path.iterdir())) == 2


@needs_compiler
def test_source_that_does_not_compile_or_a_place_that_cannot_be_written_is_done_without(tmp_path):
    assert load_library("no C", tmp_path) is None
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "file").write_text("")
    assert load_library("int a;", tmp_path / "file") is None


def test_without_a_compiler_everything_still_works(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", os.fspath(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    assert find_compiler() is None
    arm = read_arm("column")
    ik = InverseKinematics(arm)
    assert ik.engine.name == "numpy"
    assert ik.solve(arm.chain.base_from_tool(np.full((3, 5), 0.1))).converged.all()
    with pytest.raises(BadParameter, match="no C compiler here"):
        InverseKinematics(arm, compiled=True)


def test_the_cache_is_the_users(monkeypatch, tmp_path):
    if os.name == "posix" and os.uname().sysname == "Linux":
        monkeypatch.setenv("XDG_CACHE_HOME", os.fspath(tmp_path))
        assert cache_folder() == tmp_path / "vision-robot"


@needs_compiler
def test_c_and_numpy_compute_the_same(tmp_path):
    """Its own sine, arc tangent and rounding included: to 1e-13 over all branches."""
    chain = read_arm("column").chain
    program = program_of(chain, Task.POSE)
    c, plain = compiled_engine(program, tmp_path), NumpyEngine(program)
    assert c is not None
    q = np.random.default_rng(0).uniform(*windows(chain).T, size=(1003, 5))  # no multiple of the lanes
    goals = chain.base_from_tool(q).as_matrix()[:, :3].reshape(-1, 12)
    for one, other in zip(c.closed(goals), plain.closed(goals), strict=True):
        assert np.abs(one - other).max() < 1e-10
    assert np.allclose(c.errors(goals, q[::-1]), plain.errors(goals, q[::-1]), rtol=0, atol=1e-13)
    near, ones = np.zeros((1, 5)), np.ones(5)
    choice = {"near": near, "weights": ones, "periods": np.zeros(5), "tolerance": (1e-6, 1e-5)}
    for one, other in zip(c.choose(goals, **choice), plain.choose(goals, **choice), strict=True):
        assert np.abs(one - other).max() < 1e-10
    for first in (None, q + 0.01):
        one = c.numeric(goals, first=first, tries=60, iterations=15)
        assert c.errors(goals, one).max() < 1e-6
        assert np.median(np.abs(one - plain.numeric(goals, first=first, tries=60, iterations=15))) < 1e-9
