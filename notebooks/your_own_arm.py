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
# # Add your own arm
#
# An arm is a file: MJCF or URDF. Nothing in the library knows a length, so an arm that nobody here has
# seen gets inverse kinematics, checks, maps and C code for its microcontroller in the next few cells. The
# arm of this notebook is a small desktop one of five turning joints, such as one prints and builds in a
# weekend.

# %%
import shutil
import subprocess
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from vision_robot.arm import read_arm
from vision_robot.arm.closed_form import structure_of
from vision_robot.arm.consistency import check_consistency
from vision_robot.arm.export_c import export_c
from vision_robot.arm.ik import InverseKinematics
from vision_robot.arm.paths import follow, line
from vision_robot.arm.unreachable import Unreachable
from vision_robot.arm.workspace import tool_down, workspace
from vision_robot.errors import VisionRobotError
from vision_robot.geometry import SE3, Camera
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.render import Renderer

np.set_printoptions(suppress=True, precision=4)
plt.style.use("look.mplstyle")
folder = Path(tempfile.mkdtemp())

# %% [markdown]
# ## The file
#
# Bodies inside bodies; each joint says where it is, what it turns about and how far. A site named `tool`
# marks the point between the fingers, its z along them. Shapes (`geom`) are for pictures and physics;
# kinematics does not need them.

# %%
MJCF = """
<mujoco model="desk arm">
  <compiler angle="degree"/>
  <option jacobian="dense"/>
  <worldbody>
    <light pos="0.3 -0.3 0.8" dir="-0.3 0.3 -0.8"/>
    <geom type="plane" size="0.5 0.5 0.01" rgba="0.86 0.84 0.8 1"/>
    <body name="base">
      <geom type="cylinder" size="0.045 0.02" pos="0 0 0.02" rgba="0.2 0.23 0.28 1"/>
      <body name="turret" pos="0 0 0.045">
        <joint name="waist" axis="0 0 1" range="-150 150"/>
        <geom type="cylinder" size="0.03 0.025" pos="0 0 0.02" rgba="0.85 0.45 0.15 1"/>
        <body name="upper" pos="0 0 0.05">
          <joint name="shoulder" axis="0 1 0" range="-30 110"/>
          <geom type="capsule" fromto="0 0 0 0 0 0.12" size="0.014" rgba="0.3 0.45 0.7 1"/>
          <body name="fore" pos="0 0 0.12">
            <joint name="elbow" axis="0 1 0" range="-10 140"/>
            <geom type="capsule" fromto="0 0 0 0 0 0.12" size="0.012" rgba="0.3 0.45 0.7 1"/>
            <body name="hand" pos="0 0 0.12">
              <joint name="wrist" axis="0 1 0" range="-100 100"/>
              <geom type="capsule" fromto="0 0 0 0 0 0.03" size="0.011" rgba="0.2 0.23 0.28 1"/>
              <body name="gripper" pos="0 0 0.03">
                <joint name="roll" axis="0 0 1" range="-180 180"/>
                <geom type="box" size="0.022 0.008 0.006" pos="0 0 0.012" rgba="0.2 0.23 0.28 1"/>
                <geom type="box" size="0.003 0.006 0.018" pos="0.018 0 0.034" rgba="0.85 0.45 0.15 1"/>
                <geom type="box" size="0.003 0.006 0.018" pos="-0.018 0 0.034" rgba="0.85 0.45 0.15 1"/>
                <site name="tool" pos="0 0 0.05"/>
              </body>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
path = folder / "desk_arm.xml"
path.write_text(MJCF)
arm = read_arm(path)
chain = arm.chain
print(f"{arm.name}: {len(arm)} joints, reach {1000 * arm.reach_m:.0f} mm, tool {arm.tool!r}")
for name, (low, high) in zip(chain.joint_names, np.degrees(chain.limits), strict=True):
    print(f"  {name:9s}{low:6.0f} to {high:4.0f} deg")
print(*arm.assumed, sep="\n")

# %% [markdown]
# What the file leaves open is assumed aloud, and what cannot be an arm is refused with what is in the
# way:

# %%
for wrong, (old, new) in {
    "no tool": ('<site name="tool" pos="0 0 0.05"/>', ""),
    "limits in degrees": ('angle="degree"', 'angle="radian"'),
}.items():
    bad = folder / "bad.xml"
    bad.write_text(MJCF.replace(old, new))
    try:
        other = read_arm(bad)
        print(f"{wrong}: {np.degrees(other.chain.limits[0])} deg for the waist")
    except VisionRobotError as error:
        print(f"{wrong}: {str(error).replace(str(folder), '.')}")

# %% [markdown]
# Mixed-up degrees are a mistake that no program can be sure of: look at the limits it prints.
#
# ## The same arm as URDF
#
# Robots of the ROS world come as URDF. The reader makes the same chain of it; here the text is written
# from the MJCF's numbers, and both bring the tool to the same place.


# %%
def as_urdf(chain):
    """A URDF of the chain, links without shapes."""
    lines = ['<robot name="desk arm">', '<link name="base"/>']
    before = "base"
    for i, name in enumerate(chain.joint_names):
        x, y, z = chain.link_from_joint.translation[i]
        a, b, c = chain.axes[i]
        low, high = chain.limits[i]
        lines.append(
            f'<link name="{name}_link"/><joint name="{name}" type="revolute"><parent link="{before}"/>'
            f'<child link="{name}_link"/><origin xyz="{x} {y} {z}"/><axis xyz="{a} {b} {c}"/>'
            f'<limit lower="{low}" upper="{high}" effort="1" velocity="1"/></joint>'
        )
        before = f"{name}_link"
    x, y, z = (chain.last_from_wrist @ chain.wrist_from_tool).translation
    lines.append(
        f'<link name="tool"/><joint name="tip" type="fixed"><parent link="{before}"/><child link="tool"/>'
        f'<origin xyz="{x} {y} {z}"/></joint></robot>'
    )
    return "\n".join(lines)


(folder / "desk_arm.urdf").write_text(as_urdf(chain))
twin = read_arm(folder / "desk_arm.urdf", tool="tool")
rng = np.random.default_rng(0)
q = rng.uniform(chain.limits[:, 0], chain.limits[:, 1], (1000, 5))
apart = chain.base_from_tool(q).translation - twin.chain.base_from_tool(q).translation
print(f"MJCF and URDF differ by {np.abs(apart).max():.1e} m at most over 1000 postures")
assert np.abs(apart).max() < 1e-12

# %% [markdown]
# ## Does it hold together?
#
# `vr ik check` draws joint values inside the limits, brings the tool there, and asks the inverse for joint
# values: what comes back must bring the tool to the same pose. The kind of arm is recognised by its axes;
# where a closed form is known it is used, else the search.

# %%
print(structure_of(chain))
for row in check_consistency(arm, targets=1000):
    print(
        f"{row.method:12s} {row.reached} of {row.targets} reached, {row.wrong} wrong, "
        f"worst {1e6 * row.position_error_m:.2g} um, {row.solves_per_s:,.0f} a second"
    )
    assert row.wrong == 0
    assert row.reached == row.targets

# %% [markdown]
# ## Look at it move
#
# A straight line over the desk with the tool pointing down: joints follow it without a jump from branch
# to branch, or what stops them is said. With the fingers turned by a quarter the roll joint has room.

# %%
ik = InverseKinematics(arm)


def across(yaw):
    """Over the desk, 160 mm before the waist, from right to left."""
    return line(*(SE3(tool_down(yaw), np.array([0.16, y, 0.05])) for y in (-0.12, 0.12)))


try:
    follow(ik, across(0.0))
except VisionRobotError as error:
    print("fingers closing along x:", error)
way = follow(ik, across(np.pi / 2))
print(f"closing along y: {len(way.q)} postures, off the line by {1e6 * way.error_m:.2g} um at most")
mujoco = load_mujoco()
model = mujoco.MjModel.from_xml_path(str(path))
state = mujoco.MjData(model)
camera = Camera(360, 300, 420, 420, 179.5, 149.5)
z = np.array([-0.62, 0.55, -0.55]) / np.linalg.norm([0.62, 0.55, 0.55])
x = np.cross(z, [0, 0, 1.0])
x /= np.linalg.norm(x)
world_from_cam = SE3(np.stack([x, np.cross(z, x), z], axis=1), np.array([0.08, 0, 0.1]) - 0.62 * z)
figure, axes = plt.subplots(1, 4, figsize=(10, 2.4))
with Renderer(model, state) as renderer:
    for axis, k in zip(axes[:3], (0, len(way.q) // 2, -1), strict=True):
        state.qpos[:] = way.q[k]
        mujoco.mj_forward(model, state)
        at = state.site("tool").xpos
        assert np.allclose(at, chain.base_from_tool(way.q[k]).translation, atol=1e-9)
        axis.imshow(renderer.render(camera, world_from_cam)[..., ::-1])
        axis.axis("off")
axes[3].plot(np.degrees(way.q))
axes[3].set(title="joints [deg]", xlabel="posture")
axes[3].legend(chain.joint_names, fontsize=6)
plt.show()

# %% [markdown]
# MuJoCo's own kinematics agrees with the library's to a nanometre: the pictures are drawn by the one, the
# joints come from the other.
#
# ## What can it pick?

# %%
found = workspace(ik, height_m=0.02, cells=81)
figure, axes = plt.subplots(1, 2, figsize=(9, 3.6))
for axis, part, up in zip(axes, (found.level, found.upright), ("y [mm]", "z [mm]"), strict=True):
    shade = axis.pcolormesh(1000 * part.across_m, 1000 * part.up_m, part.manipulability, cmap="Blues")
    axis.contour(
        1000 * part.across_m, 1000 * part.up_m, part.reached, levels=[0.5], colors=["#20262e"], linewidths=0.8
    )
    axis.plot(0, 0, "+", color="C1", markersize=10)
    axis.set(aspect="equal", xlabel="x [mm]", ylabel=up)
axes[0].set_title("tool down, 20 mm over the desk")
axes[1].set(title="upright, tool down", ylim=(-60, 330))
plt.show()
cell = np.prod([np.diff(axis[:2])[0] for axis in (found.level.across_m, found.level.up_m)])
area = float(found.level.reached.sum() * cell)
print(f"{1e4 * area:.0f} cm2 of the desk")
assert area > 0.02
far = SE3(tool_down(np.zeros(1)), np.array([[0.3, 0.0, 0.02]]))
print(Unreachable(ik).reason(far, ik.solve(far), 0).text)

# %% [markdown]
# ## Onto the microcontroller
#
# `vr ik export desk_arm.xml -o firmware/ik` writes forward and inverse kinematics as C99: no heap, nothing
# but `math.h`.

# %%
export = export_c(arm, folder / "ik", precision="single")
how = f"closed form ({export.structure}), {export.branches} branches" if export.starts is None else "search"
print(f"{how}; {len(export.files)} files, code {export.cost.code} B ({export.cost.source})")
print("about", export.cycles.usual, "cycles a solve")
print("".join((export.folder / "vr_arm.h").read_text().splitlines(keepends=True)[:12]))
if shutil.which("make") and shutil.which("cc"):
    test = subprocess.run(["make", "test"], cwd=export.folder, capture_output=True, text=True, check=False)
    print(test.stdout.splitlines()[-1])
    assert test.returncode == 0

# %% [markdown]
# The folder's self-test compares the C code with joint values that this library computed, so the next
# build on the real chip proves itself. From here: `vr ik stream` sends joint values to it,
# `vr extrinsics hand-eye --arm desk_arm.xml` calibrates the camera on it, and `--geometry` corrects its
# links.
