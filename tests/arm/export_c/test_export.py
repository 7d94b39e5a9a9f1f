"""The exported C compiles without a warning, needs nothing but math.h, and answers as Python does."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from tests.arm.arms import PANDA, UR5E
from tests.arm.compiled import STRICT, CompiledArm, arm_of, column_arm, goals_inside, needs_gcc, rows
from vision_robot.arm import Task
from vision_robot.arm.closed_form import closed_form_of
from vision_robot.arm.export_c import export_c
from vision_robot.arm.ik import InverseKinematics
from vision_robot.arm.model import Arm
from vision_robot.arm.symbolic import length_scale
from vision_robot.arm.vectorised import Vectorised
from vision_robot.errors import BadParameter, UnknownStructure
from vision_robot.geometry import SE3, SerialChain

TARGETS = 1000
WITHIN = {"double": (1e-9, 1e-9), "single": (1e-5, 1e-4)}
"""[m] and [rad or m]; 1e-5 m is a hundredth of a millimetre."""

BOTH = pytest.mark.parametrize("precision", ["single", "double"])
EACH = pytest.mark.parametrize("method", ["closed-form", "numeric"])


def turned_towards(chain: SerialChain, branches: np.ndarray, now: np.ndarray) -> np.ndarray:
    """Branches with whole turns added that bring them nearest to `now` inside the limits."""
    turns = 2 * np.pi * np.arange(-2, 3)[:, None, None] * ~chain.slides
    choices = branches + turns
    outside = (choices < chain.limits[:, 0] - 1e-9) | (choices > chain.limits[:, 1] + 1e-9)
    away = np.where(outside, np.inf, np.abs(choices - now))
    return np.take_along_axis(choices, away.argmin(axis=0)[None], axis=0)[0]


def python_branches(arm: Arm, goals: np.ndarray) -> list[np.ndarray]:
    """All answers inside the limits for each goal, from the closed form in numpy."""
    closed = closed_form_of(arm.chain)
    q, errors = Vectorised(closed.function)(goals.T)
    every = q.T.reshape(len(goals), closed.branches, len(arm))
    errors = errors.T.reshape(len(goals), closed.branches, 2)
    good = (errors[..., 0] < 1e-8) & (errors[..., 1] < 1e-6) & arm.chain.within_limits(every, slack=1e-9)
    return [some[keep] for some, keep in zip(every, good, strict=True)]


@needs_gcc
@BOTH
@EACH
@pytest.mark.parametrize("name", ["column", "ur5e"])
def test_a_thousand_goals_are_answered_as_in_python(compiled, method, precision, name):
    arm = compiled(method, precision, name)
    chain = arm.arm.chain
    targets = TARGETS if name == "column" else 300
    q, goals = goals_inside(arm.arm, targets, seed=3)
    nows = np.roll(q, 1, axis=0)
    reached, joints = arm.solve_many(goals, nows)
    assert reached.all()
    low, high = (np.asarray(side, dtype=joints.dtype) for side in chain.limits.T)
    assert ((joints >= low) & (joints <= high)).all()  # no slack at all: limits are hard
    metres, radians = WITHIN[precision]
    missed = chain.base_from_tool(joints).inverse() @ chain.base_from_tool(q)
    assert np.linalg.norm(missed.translation, axis=1).max() < metres
    assert np.linalg.norm(missed.rotvec(), axis=1).max() < max(radians, 5e-8)

    # The joints themselves: one of Python's branches, and of the closed form the nearest one.
    scale = 1 / np.where(chain.slides, length_scale(chain), 1.0)
    firm = 0
    loosest = np.linalg.svd(chain.jacobian(joints), compute_uv=False)[:, -1]
    for k, (answer, now, given) in enumerate(zip(joints, nows, python_branches(arm.arm, goals), strict=True)):
        branches = turned_towards(chain, given, now)
        off = np.abs(branches - answer).max(axis=1)
        spread = np.linalg.norm((branches - now) * scale, axis=1)
        if len(branches) > 1 and np.diff(np.sort(spread)).min() < 1e-2:
            continue  # two branches about as near, or about to meet
        firm += 1
        # What the pose leaves open of the joints, near where the arm is singular.
        assert off.min() < max(metres, radians) / loosest[k]
        if method == "closed-form":
            assert off.argmin() == spread.argmin()
    assert firm > 0.8 * targets


@needs_gcc
@BOTH
@pytest.mark.parametrize("name", ["column", "ur5e"])
def test_the_branch_is_the_one_that_python_takes(compiled, precision, name):
    arm = compiled("closed-form", precision, name)
    chain = arm.arm.chain
    q, goals = goals_inside(arm.arm, 400, seed=12)
    nows = np.roll(q, 1, axis=0)
    reached, joints = arm.solve_many(goals, nows)
    solver = InverseKinematics(arm.arm, compiled=False)
    python = solver.solve(chain.base_from_tool(q), near=nows)
    assert reached.all()
    assert python.converged.all()
    metres, radians = WITHIN[precision]
    off = np.abs(joints - python.q).max(axis=1)
    loosest = np.linalg.svd(chain.jacobian(joints), compute_uv=False)[:, -1]
    same = off < max(metres, radians) / loosest
    weights = np.where(chain.slides, 1 / length_scale(chain) ** 2, 1.0)
    ours, theirs = (np.sqrt((one - nows) ** 2 @ weights) for one in (joints, python.q))
    # Where they differ ours is not the farther one; of joints with more than a turn it may be the nearer.
    assert (ours - theirs)[~same].max(initial=0) < 1e-3
    assert same.mean() > (0.98 if name == "column" else 0.5)


@needs_gcc
@BOTH
def test_forward_kinematics(compiled, precision):
    arm = compiled("closed-form", precision)
    q, poses = goals_inside(arm.arm, 200, seed=5)
    got = np.array([arm.forward(one) for one in q])
    assert np.abs(got - poses).max() < (1e-14 if precision == "double" else 5e-7)


@needs_gcc
@BOTH
def test_all_branches(compiled, precision):
    arm = compiled("closed-form", precision, "ur5e")
    _, goals = goals_inside(arm.arm, 200, seed=6)
    several = 0
    within = (
        1e-9 if precision == "double" else 2e-3
    )  # where two branches nearly meet singles tell them less well
    for goal, branches in zip(goals, python_branches(arm.arm, goals), strict=True):
        got = arm.branches(goal)
        # In single precision a branch within a hair of a limit may fall on either side of it.
        inside = branches[arm.arm.chain.within_limits(branches, slack=-1e-5)]
        assert len(got) >= len(inside)
        for one in inside:
            assert np.abs(got - one).max(axis=1).min() < within
        several += len(inside) > 1
    assert several > 150


@needs_gcc
@BOTH
@EACH
def test_goals_out_of_reach_are_refused(compiled, method, precision):
    arm = compiled(method, precision)
    now = arm.arm.chain.limits.mean(axis=1)
    far = arm.forward(now)
    far[3] += 0.5
    reached, q, error = arm.solve(far, now)
    assert not reached
    assert arm.arm.chain.within_limits(q, slack=1e-6)
    assert error[0] > 0.1
    _, goals = goals_inside(arm.arm, 1, seed=1)
    for spoiled in (np.full(12, np.nan), np.where(np.arange(12) == 7, np.inf, goals[0])):
        assert not arm.solve(spoiled, now)[0]


@needs_gcc
@pytest.mark.parametrize("w", [(0, 0, 0), (1e-9, 0, 0), (1e-3, -2e-3, 5e-4), (0.9, 2, -0.3), (0, 0, np.pi)])
def test_pose_from_rotation_vector(compiled, w):
    arm = compiled("closed-form", "double")
    pose, p = arm.array(np.zeros(12)), np.array([0.1, -0.2, 0.3])
    arm.library.vr_pose_from_rotvec(arm.array(p), arm.array(np.array(w)), pose)
    assert np.allclose(pose[:], rows(SE3.from_rotvec(np.array(w, dtype=float), p)), atol=1e-14)


@needs_gcc
@BOTH
@EACH
@pytest.mark.parametrize("tilt", [0.0, 1e-7, 1e-5, 1e-3])
def test_the_tool_pointing_straight_down(compiled, method, precision, tilt):
    """Picking from a table, where two branches of the column arm meet."""
    arm = compiled(method, precision)
    q, _ = goals_inside(arm.arm, 200, seed=1)
    q[:, 3] = tilt
    goals = rows(arm.arm.chain.base_from_tool(q))
    assert arm.solve_many(goals, np.roll(q, 1, axis=0))[0].all()
    if method == "closed-form" and tilt == 0:
        # Elbow on either side, each told once.
        counts = [len(arm.branches(goal)) for goal in goals]
        assert set(counts) <= {1, 2}
        assert np.mean(np.array(counts) == 2) > 0.7


@needs_gcc
def test_joints_with_more_than_a_turn_come_back_near_the_present_ones(tmp_path):
    wide = replace(UR5E, limits=np.tile([-2 * np.pi, 2 * np.pi], (6, 1)))
    arm = CompiledArm(arm_of(wide), tmp_path, method="closed-form", precision="double")
    q, goals = goals_inside(arm.arm, 100, seed=2)
    for joints, goal in zip(q, goals, strict=True):
        reached, answer, _ = arm.solve(goal, joints)
        assert reached
        assert np.abs(answer - joints).max() < 1e-7


@needs_gcc
@pytest.mark.parametrize(("chain", "method"), [(UR5E, "closed-form"), (UR5E, "numeric"), (PANDA, "numeric")])
def test_other_arms(tmp_path, chain, method):
    arm = CompiledArm(arm_of(chain), tmp_path, method=method, precision="single")
    q, goals = goals_inside(arm.arm, 200, seed=9)
    reached, joints = arm.solve_many(goals, np.roll(q, 1, axis=0))
    assert reached.all()
    missed = chain.base_from_tool(joints).inverse() @ chain.base_from_tool(q)
    assert np.linalg.norm(missed.translation, axis=1).max() < 1e-5


@needs_gcc
@BOTH
def test_the_arm_all_but_outstretched(compiled, precision):
    """Where two branches meet, rounding of the goal is felt most: the closed form alone would miss some."""
    arm = compiled("closed-form", precision)
    q, _ = goals_inside(arm.arm, 500, seed=21)
    q[:, 2] = np.random.default_rng(3).choice([1, -1], 500) * 10.0 ** np.linspace(-9, -2, 500)
    goals = rows(arm.arm.chain.base_from_tool(q))
    reached, joints = arm.solve_many(goals, np.roll(q, 1, axis=0))
    assert reached.all()
    missed = arm.arm.chain.base_from_tool(joints).inverse() @ arm.arm.chain.base_from_tool(q)
    assert np.linalg.norm(missed.translation, axis=1).max() < WITHIN[precision][0]


@needs_gcc
def test_an_arm_a_little_off_its_kind_is_polished(tmp_path):
    """Files round right angles to 1.5708: the closed form is then off by micrometres, the answers are not."""
    rotation = UR5E.link_from_joint.rotation.copy()
    rotation[1] = rotation[1] @ SE3.from_rotvec(np.array([4e-6, 0, 0]), np.zeros(3)).rotation
    chain = replace(UR5E, link_from_joint=replace(UR5E.link_from_joint, rotation=rotation))
    assert not closed_form_of(chain).exact
    arm = CompiledArm(arm_of(chain), tmp_path, method="closed-form", precision="double")
    q, goals = goals_inside(arm.arm, 200, seed=9)
    reached, joints = arm.solve_many(goals, np.roll(q, 1, axis=0))
    assert reached.mean() > 0.97  # the others lie at a limit or where two branches meet
    missed = chain.base_from_tool(joints).inverse() @ chain.base_from_tool(q)
    assert np.linalg.norm(missed.translation, axis=1)[reached].max() < 1e-9


@needs_gcc
@pytest.mark.skipif(shutil.which("nm") is None, reason="no nm on this machine")
@BOTH
@EACH
@pytest.mark.parametrize("optimised", ["-O0", "-Os", "-O2"])
def test_nothing_is_called_but_math(compiled, method, precision, optimised):
    arm = compiled(method, precision)
    flags = [
        *STRICT,
        optimised,
        "-ffreestanding",
        "-fno-tree-loop-distribute-patterns",
        "-fno-stack-protector",
    ]
    wanted, given = set(), set()
    for name in ("vr_ik", "vr_link"):
        subprocess.run(["gcc", *flags, "-c", f"{name}.c", "-o", f"{name}.host.o"], cwd=arm.folder, check=True)
        listing = subprocess.run(
            ["nm", f"{name}.host.o"], cwd=arm.folder, check=True, capture_output=True, text=True
        )
        for line in listing.stdout.splitlines():
            kind, symbol = line.split()[-2:]
            (wanted if kind == "U" else given).add(symbol)
    header = (arm.folder / "vr_arm.h").read_text()
    named = re.search(r"of the C library only\s+\*?\s*(.*?) of math\.h", header, re.S)
    assert named
    promised = set(re.findall(r"\w+", named[1]))
    assert wanted - given <= promised | {"vr_on_move", "vr_on_stop"}
    if precision == "single":
        assert all(name.endswith("f") for name in promised)


@needs_gcc
@pytest.mark.skipif(shutil.which("make") is None, reason="no make on this machine")
@BOTH
@EACH
def test_its_own_make_test_passes(compiled, method, precision):
    arm = compiled(method, precision)
    done = subprocess.run(
        ["make", "test", "example", "filter", "receiver"],
        cwd=arm.folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "self-test: 0 of 64 failed" in done.stdout
    shown = subprocess.run(["./example"], cwd=arm.folder, capture_output=True, text=True, check=True).stdout
    assert "10 mm lower: reached" in shown


@needs_gcc
@pytest.mark.skipif(shutil.which("make") is None, reason="no make on this machine")
def test_the_self_test_can_fail(tmp_path):
    export_c(column_arm(), tmp_path, method="closed-form")
    kernels = tmp_path / "vr_kernels.h"
    kernels.write_text(kernels.read_text().replace("0.3f", "0.301f"))
    done = subprocess.run(["make", "test"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert re.search(r"self-test: [1-9]\d* of 64 failed", done.stdout)


def test_the_header_tells_units_frames_and_limits(tmp_path):
    export = export_c(column_arm(), tmp_path)
    assert export.method == "closed-form"
    header = (tmp_path / "vr_arm.h").read_text()
    for words in ("metres and radians", "{B} is base", "slides  0 ... 0.4 m", "(-150 ... 150 deg)", "cycles"):
        assert words in header
    assert f"0x{export.fingerprint:08X}u" in header
    readme = (tmp_path / "README.md").read_text()
    assert all(f"`{name}`" in readme for name in export.files if name not in ("Makefile", "README.md"))
    assert sorted(path.name for path in tmp_path.iterdir() if path.suffix not in (".o", ".su")) == sorted(
        export.files
    )


def test_the_same_arm_gives_the_same_files(tmp_path):
    for name in ("one", "two"):
        export_c(column_arm(), tmp_path / name, method="numeric")
    for path in (tmp_path / "one").glob("*.[ch]"):
        assert path.read_text() == (tmp_path / "two" / path.name).read_text()


def test_a_calibrated_arm_gets_the_numeric_method(tmp_path):
    arm = column_arm()
    bent = replace(arm.chain.link_from_joint, translation=arm.chain.link_from_joint.translation + 0.001)
    tilted = replace(
        bent, rotation=bent.rotation @ SE3.from_rotvec(np.array([0.005, 0, 0]), np.zeros(3)).rotation
    )
    calibrated = arm.calibrated(replace(arm.chain, link_from_joint=tilted))
    assert export_c(calibrated, tmp_path).method == "numeric"
    with pytest.raises(UnknownStructure):
        export_c(calibrated, tmp_path, method="closed-form")


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"method": "magic"}, "closed-form or numeric"),
        ({"precision": "half"}, "single or double"),
        ({"target": "z80"}, "cortex-m4f"),
        ({"method": "closed-form", "task": Task.TILT}, "numeric method does the others"),
    ],
)
def test_bad_options_are_named(tmp_path, options, says):
    with pytest.raises(BadParameter, match=says):
        export_c(column_arm(), tmp_path, **options)
    assert not list(tmp_path.iterdir())
