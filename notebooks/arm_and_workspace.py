# ---
# jupyter:
#   jupytext:
#     formats: ipynb,py:percent
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # The arm and its workspace
#
# A camera knows where a rod lies on the table. The arm must bring its fingers there: from a pose in space
# to five joint values. This notebook walks the way: frames first, then forward kinematics, the branches
# of the inverse, where the arm reaches and how well it moves there, why five joints cannot reach every
# pose, and what the solver says when a goal is out of reach.

# %%
import time

import matplotlib.pyplot as plt
import numpy as np

from vision_robot.arm import Task, read_arm
from vision_robot.arm.frames import base_from_wrist
from vision_robot.arm.ik import InverseKinematics
from vision_robot.arm.paths import line
from vision_robot.arm.unreachable import Unreachable
from vision_robot.arm.workspace import tool_down, workspace
from vision_robot.geometry import SE3

np.set_printoptions(suppress=True, precision=4)
plt.style.use("look.mplstyle")
arm = read_arm("column")
chain = arm.chain
for name, slides, (low, high) in zip(chain.joint_names, chain.slides, chain.limits, strict=True):
    scale, unit = (1000, "mm") if slides else (180 / np.pi, "deg")
    print(f"{name:7s} {'slides' if slides else 'turns':7s}{scale * low:7.0f} to {scale * high:4.0f} {unit}")

# %% [markdown]
# One sliding joint and four turning ones, PRRRR. Nothing here knows a length of it: all comes from the
# MJCF file, and every cell below runs as well with another arm (`read_arm("mine.urdf")`).
#
# ## Frames
#
# {B} base, {S} station (the table), {G} goal, {W} wrist, {T} tool. `a_from_b` takes points of b to a, so
# names chain like dominoes. The text's $^B_WT = {}^B_ST\; {}^S_GT\; ({}^W_TT)^{-1}$ is:

# %%
base_from_station = SE3(np.eye(3), np.array([0.36, 0.0, 0.07]))
station_from_goal = SE3(tool_down(np.radians(30)), np.array([0.02, 0.08, 0.01]))  # a rod at 30 degrees
wanted = base_from_wrist(base_from_station, station_from_goal, chain.wrist_from_tool)
print(wanted.as_matrix())
assert np.allclose(
    wanted.as_matrix(),
    base_from_station.as_matrix()
    @ station_from_goal.as_matrix()
    @ np.linalg.inv(chain.wrist_from_tool.as_matrix()),
)

# %% [markdown]
# ## Forward, and its derivative
#
# From joints to the tool is a product of five transforms. The Jacobian says how the tool moves when
# joints do; a finite difference agrees.

# %%
q = np.array([0.15, 0.5, 0.8, 0.1, -0.4])
tool = chain.base_from_tool(q)
J = chain.jacobian(q)
step = 1e-6
for i, name in enumerate(chain.joint_names):
    moved = chain.base_from_tool(q + step * np.eye(5)[i])
    turn = (moved @ tool.inverse()).rotvec() / step
    twist = np.concatenate([(moved.translation - tool.translation) / step, turn])
    print(f"{name:7s} moves the tool by {J[:3, i]} and turns it by {J[3:, i]}")
    assert np.allclose(twist, J[:, i], atol=1e-5)

# %% [markdown]
# ## Inverse, in all its branches
#
# With the tool straight down the elbow can be left or right: two ways, fewer where a joint's limit is in
# the way. A tilted tool leaves no choice: its axis tells in which upright plane the last link must lie.
# The closed form gives all ways, to rounding.

# %%
ik = InverseKinematics(arm)
goal = base_from_station @ station_from_goal
goals = SE3(goal.rotation[None], goal.translation[None])
ways = ik.branches(goals).of_goal(0)
print(ways)
assert ik.uses_closed_form
assert len(ways) == 2
for way in ways:
    off = chain.base_from_tool(way).inverse() @ goal
    assert np.linalg.norm(off.translation) < 1e-9


def drawn(axis, q, **how):
    """The arm from above: joints and tool."""
    points = [frame.translation for frame in chain.base_from_joints(q)]
    points += [chain.base_from_wrist(q).translation, chain.base_from_tool(q).translation]
    axis.plot(*1000 * np.array(points)[:, :2].T, "o-", linewidth=3, markersize=5, **how)


figure, axes = plt.subplots(1, 2, figsize=(10, 3.6))
for k, (way, colour) in enumerate(zip(ways, ("C0", "C2"), strict=True)):
    drawn(axes[0], way, color=colour, label=f"branch {k + 1}", alpha=0.8)
rod = station_from_goal.rotation[:2, 1] * 0.07
place = goal.translation[:2]
axes[0].plot(*1000 * np.stack([place - rod, place + rod]).T, color="C1", linewidth=5, alpha=0.7, label="rod")
axes[0].set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]", title="From above: two ways to one rod")
axes[0].legend()
rng = np.random.default_rng(0)
drawn_q = rng.uniform(chain.limits[:, 0], chain.limits[:, 1], (4000, 5))
drawn_down = np.where([True, True, True, False, True], drawn_q, 0.0)
counts = {}
for k, (title, joints) in enumerate({"any tilt": drawn_q, "tool down": drawn_down}.items()):
    counts[title] = ik.branches(chain.base_from_tool(joints)).right.sum(axis=1)
    number, of = np.unique(counts[title], return_counts=True)
    axes[1].bar(number + 0.2 * (2 * k - 1), of, 0.38, color=f"C{k}", label=title)
axes[1].set(xlabel="branches inside the limits", ylabel="of 4000 goals", xticks=[1, 2])
axes[1].set_title("How many ways there are")
axes[1].legend()
plt.show()
assert all(each.min() >= 1 for each in counts.values())
assert counts["any tilt"].max() == 1
assert (counts["tool down"] == 2).mean() > 0.5

# %% [markdown]
# No goal that came from joint values is left without an answer: 4000 of 4000. And it is quick:

# %%
begun = time.process_time()
solutions = ik.solve(chain.base_from_tool(drawn_q))
seconds = time.process_time() - begun
print(
    f"{solutions.converged.sum()} of {len(solutions)} solved, "
    f"{len(solutions) / seconds:,.0f} a second ({ik.engine.name})"
)
print(f"worst error {1e9 * solutions.position_error_m.max():.2g} nm")
assert solutions.converged.all()

# %% [markdown]
# ## Where it reaches, and how well it moves there
#
# Yoshikawa's manipulability is the volume of tool velocities that joint velocities of length one can
# make: zero where the arm cannot move some way at all. From above with the tool pointing down, counting
# all joints; the same with the tool kept pointing down, for which only d1, θ2 and θ3 may move; and
# upright through the base:

# %%
found = workspace(ik, cells=101)
x, y = np.meshgrid(found.level.across_m, found.level.up_m)
places = np.stack([x, y, np.full_like(x, found.height_m)], axis=-1).reshape(-1, 3)
posture, reached = ik.sketch(SE3(tool_down(np.arctan2(places[:, 1], places[:, 0])), places))
kept = np.abs(np.linalg.det(chain.jacobian(posture)[:, :3, :3]))
kept = np.where(reached, kept, np.nan).reshape(x.shape)
panels = (
    (found.level, found.level.manipulability, "y [mm]", f"from above, at {1000 * found.height_m:.0f} mm"),
    (found.level, kept, "y [mm]", "from above, tool kept down"),
    (found.upright, found.upright.manipulability, "z [mm]", "upright"),
)
figure, axes = plt.subplots(1, 3, figsize=(10, 3.5))
for axis, (part, value, up, title) in zip(axes, panels, strict=True):
    across, along = 1000 * part.across_m, 1000 * part.up_m
    shade = axis.pcolormesh(across, along, value / np.nanmax(value), cmap="Blues", vmin=0, vmax=1)
    axis.contour(across, along, part.reached, levels=[0.5], colors=["#20262e"], linewidths=0.8)
    axis.plot(0, 0, "+", color="C1", markersize=10)
    axis.set(aspect="equal", xlabel="x [mm]", ylabel=up, title=title)
rows = np.flatnonzero(found.upright.reached.any(axis=1))
axes[2].set_ylim(1000 * found.upright.up_m[rows[0]] - 150, 1000 * found.upright.up_m[rows[-1]] + 150)
figure.colorbar(shade, ax=axes, shrink=0.7, label="share of the best")
plt.show()
radius = np.hypot(places[:, 0], places[:, 1]).reshape(x.shape)
ring = [np.nanmean(kept[(radius > a) & (radius < b)]) for a, b in ((0.15, 0.25), (0.33, 0.43), (0.5, 0.54))]
assert ring[1] > ring[0]
assert ring[1] > ring[2]

# %% [markdown]
# With all joints the outer rim looks as good as any place: there the wrist's pitch still moves the finger
# tips. With the tool kept down the truth comes out, pale at both rims, where the arm is stretched or
# folded. A straight line that touches the rim asks joints to run: here two lines of the same length and
# the joint speeds they cost.

# %%
figure, axes = plt.subplots(1, 2, figsize=(10, 2.6), sharey=True)
fastest = {}
for axis, (title, x) in zip(axes, (("through the middle", 0.36), ("along the rim", 0.535)), strict=True):
    start, end = (SE3(tool_down(0.0), np.array([x, y, 0.1])) for y in (-0.12, 0.12))
    path = line(start, end)
    joints = ik.solve(path, near=ik.solve(SE3(path.rotation[:1], path.translation[:1])).q[0]).q
    length = np.linalg.norm(path.translation - path.translation[0], axis=1)
    rate = np.abs(np.gradient(joints[:, 1:], 1000 * length, axis=0))
    for k in range(4):
        axis.plot(1000 * length, np.degrees(rate[:, k]), label=chain.joint_names[k + 1])
    axis.set(title=title, xlabel="way of the tool [mm]")
    fastest[title] = np.degrees(rate.max())
axes[0].set_ylabel("joint speed [deg a mm]")
axes[0].legend(ncols=2)
plt.show()
assert fastest["along the rim"] > 1.5 * fastest["through the middle"]

# %% [markdown]
# ## Why five joints cannot reach every pose
#
# A pose has six numbers: place and orientation. Five joints span a set of five dimensions in it, so a
# pose drawn at random is missed with certainty, by little or much. What this arm gives is any place, with
# a tilt, as far as its wrist pitches, in the upright plane of its last link. A tool that points straight
# down is always among those: picking from a table, at every yaw, is all it needs.

# %%
n = 2000
turns = SE3.from_rotvec(rng.normal(size=(n, 3)), np.zeros((n, 3))).rotation
inside = rng.uniform(-np.pi, np.pi, n), np.sqrt(rng.uniform(0.15**2, 0.5**2, n)), rng.uniform(0.1, 0.35, n)
places = np.stack([inside[1] * np.cos(inside[0]), inside[1] * np.sin(inside[0]), inside[2]], axis=1)
few = slice(0, 150)
random_poses = SE3(turns[few], places[few])
down = SE3(tool_down(rng.uniform(-np.pi, np.pi, n)), places)
numeric = {}
for title, poses, task in (
    ("random pose", random_poses, Task.POSE),
    ("random place and tilt", random_poses, Task.TILT),
    ("random place alone", random_poses, Task.POSITION),
    ("tool down, any yaw", down[few], Task.POSE),
):
    solver = ik if task is Task.POSE else InverseKinematics(arm, task)
    numeric[title] = solver.solve(poses).converged.mean()
    print(f"{title:24s} {100 * numeric[title]:5.1f} % reached")
assert numeric["random pose"] == 0
assert numeric["tool down, any yaw"] > 0.7

# %% [markdown]
# The rank of the Jacobian says the same: of the six ways a tool can move or turn, five joints give five
# at most. The sixth, and how it stands here:

# %%
U, S, _ = np.linalg.svd(chain.jacobian(q))
print("singular values", S)
print("cannot: move", U[:3, 5], "while turning", U[3:, 5])
assert len(S) == 5
assert S.min() > 0.01

# %% [markdown]
# ## Out of reach, and why
#
# The solver never answers with a wrong number in silence: a goal that is not reached comes with the
# joints that come closest, how far off they are, and the reason in words.

# %%
cases = {
    "too far": SE3(tool_down(0.0), np.array([0.62, 0.0, 0.1])),
    "too high": SE3(tool_down(0.0), np.array([0.35, 0.1, 0.62])),
    "too near": SE3(tool_down(0.0), np.array([0.05, 0.02, 0.1])),
    "turned aside": SE3(
        SE3.from_rotvec(np.array([0.5, 0, 0]), np.zeros(3)).rotation @ tool_down(0.3),
        np.array([0.35, 0.1, 0.2]),
    ),
}
explain = Unreachable(ik)
for title, one in cases.items():
    asked = SE3(one.rotation[None], one.translation[None])
    solution = ik.solve(asked)
    assert not solution.converged[0]
    reason = explain.reason(asked, solution, 0)
    print(f"{title}: ({reason.kind}) {reason.text}\n")
    assert reason.position_error_m > 1e-6 or reason.orientation_error_rad > 1e-5

# %% [markdown]
# `vr ik solve` prints these reasons, `vr ik check --report` draws the maps for your own arm's file; the
# notebook `your_own_arm` begins with one.
