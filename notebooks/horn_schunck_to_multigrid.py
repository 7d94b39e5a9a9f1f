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
# # Horn–Schunck, from sweeps to multigrid
#
# Horn and Schunck (1981) wrote down what optical flow should be: brightness is kept, and neighbours move
# alike. Their energy has one minimum. Their iteration walks towards it, slowly; most programs stop after a
# hundred steps and call where they are "Horn–Schunck flow". This notebook measures how far that is from what
# was meant, why, and how to get there in less time than a few sweeps.

# %%
import time

import cv2
import matplotlib.pyplot as plt
import numpy as np

import vision_robot as vr
from vision_robot.flow import (
    FlowEquations,
    FlowEstimator,
    Multigrid,
    cube,
    flow_error,
    horn_schunck,
    horn_schunck_sweeps,
    minimise,
)
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import CellDesign, Item, Lights, Table, look_at
from vision_robot.sim.paths import Straight
from vision_robot.sim.true_flow import true_flow
from vision_robot.sim.truth import TruthRenderer

plt.style.use("look.mplstyle")
cv2.setNumThreads(1)  # all methods on one core

# %% [markdown]
# ## Two pictures whose flow is known
#
# A rendered table with four things on it that move, seen by a camera that moves a little as well. `true_flow`
# knows from depth and poses where every pixel goes. One pair moves by about a pixel, as the method of 1981
# needs it; another by ten times as much.

# %%
camera = vr.Camera(480, 360, 520, 520, 239.5, 179.5)
view = look_at(camera, (-0.1, 0.05, 0.55))
things = (
    Item(
        "disc",
        "disc",
        (0.09, 0.012),
        (0.2, 0.5, 0.8),
        path=Straight((-0.08, -0.1, 0, 0), (0.02, 0.03, 0, 0.3)),
    ),
    Item(
        "box",
        "box",
        (0.08, 0.06, 0.03),
        (0.8, 0.3, 0.2),
        path=Straight((0.06, 0.1, 0, 0.4), (-0.03, -0.02, 0, -0.4)),
    ),
    Item("pencil", path=Straight((0.0, 0.0, 0, 0.7), (0.02, -0.03, 0, 0.5))),
    Item(
        "rod", "rod", (0.16, 0.02), (0.3, 0.6, 0.3), path=Straight((0.07, -0.09, 0, 2.0), (-0.03, 0.02, 0, 0))
    ),
)
cell = Cell(CellDesign(items=things, table=Table(surface="speckled"), lights=Lights(shadows=False)))
shake = vr.SE3.from_rotvec(np.array([0.0012, -0.0010, 0.003]), np.zeros(3))
with TruthRenderer(cell, view, depth=True) as eye:
    cell.at(0.0)
    frames = [eye.frame()]
    cell.at(0.035)
    frames.append(eye.frame(shake @ view.cam_from_station))
    cell.at(0.35)
    frames.append(eye.frame(vr.SE3.exp(8 * shake.log()) @ view.cam_from_station))
first, second, far = (cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY) for frame in frames)
small, large = true_flow(frames[0], frames[1]), true_flow(frames[0], frames[2])
for name, flow in (("small", small), ("large", large)):
    length = np.linalg.norm(flow.flow_px, axis=-1)
    print(f"{name} motion: {length.mean():.2f} px in the mean, {length.max():.1f} px at most")


def colours(flow, most):
    """Direction as hue, length as saturation; white is still. Flow (height, width, 2)."""
    hsv = np.zeros((*flow.shape[:2], 3), np.float32)
    hsv[..., 0] = np.degrees(np.arctan2(flow[..., 1], flow[..., 0])) % 360
    hsv[..., 1] = np.clip(np.linalg.norm(flow, axis=-1) / most, 0, 1)
    hsv[..., 2] = 1
    return cv2.cvtColor(hsv, cv2.COLOR_HSV2RGB)


figure, axes = plt.subplots(1, 3, figsize=(10, 2.8))
axes[0].imshow(cv2.GaussianBlur(frames[0].image, (0, 0), 1)[..., ::-1])
axes[1].imshow(colours(small.flow_px, 2.5))
axes[2].imshow(colours(large.flow_px, 25))
for axis, title in zip(
    axes, ("first picture", "true flow, small motion", "true flow, large motion"), strict=True
):
    axis.set_title(title)
    axis.axis("off")
plt.show()

# %% [markdown]
# ## One equation, two unknowns
#
# Brightness is kept: $E_x u + E_y v + E_t = 0$. One pixel knows only the motion across its own edge. So
# smoothness comes in, weighed by α:
#
# $$\min_{u,v}\ \sum (E_x u + E_y v + E_t)^2 + \alpha^2\left(|\nabla u|^2 + |\nabla v|^2\right)$$
#
# Setting the derivative to zero gives two linear equations for each pixel, coupled to its neighbours. Horn
# and Schunck solve them by sweeps: replace each pixel's flow by the average of its neighbours', corrected
# along the gradient. In ten lines:


# %%
def sweeps(first, second, alpha, n):
    """Their iteration, word by word."""
    Ex, Ey, Et = cube(first, second)
    kernel = np.array([[1, 2, 1], [2, 0, 2], [1, 2, 1]], np.float32) / 12
    u, v = np.zeros_like(Ex), np.zeros_like(Ex)
    for _ in range(n):
        mean_u = cv2.filter2D(u, -1, kernel, borderType=cv2.BORDER_REPLICATE)
        mean_v = cv2.filter2D(v, -1, kernel, borderType=cv2.BORDER_REPLICATE)
        step = (Ex * mean_u + Ey * mean_v + Et) / (alpha**2 + Ex**2 + Ey**2)
        u, v = mean_u - Ex * step, mean_v - Ey * step
    return np.stack([u, v])


ALPHA = 15.0
assert np.allclose(
    sweeps(first, second, ALPHA, 20), horn_schunck_sweeps(first, second, alpha=ALPHA, sweeps=20), atol=1e-5
)

# %% [markdown]
# The true minimiser is found by thirty multigrid cycles in double precision; the equations' own residual
# says that it is one.

# %%
x, y, t = (d.astype(np.float64) for d in cube(first, second))
minimum = minimise(FlowEquations(x, y, t, ALPHA), tolerance_px=1e-9)
goal = minimum.flow
print(f"found to within {minimum.distance_px:.1e} px in {minimum.cycles} cycles")
assert minimum.distance_px < 1e-6


def distance(flow):
    """From the true minimiser, rms over the picture [px]."""
    return float(np.sqrt(np.mean(np.sum((flow - goal) ** 2, axis=0))))


counts = (1, 10, 100, 1000)
swept = {n: horn_schunck_sweeps(first, second, alpha=ALPHA, sweeps=n) for n in counts}
figure, axes = plt.subplots(1, 5, figsize=(10, 1.9))
for axis, (name, flow) in zip(
    axes, [*((f"{n} sweep{'s' * (n > 1)}", f) for n, f in swept.items()), ("the minimum", goal)], strict=True
):
    axis.imshow(colours(np.moveaxis(flow, 0, -1).astype(np.float32), 2.5))
    axis.set_title(f"{name}\n{distance(flow):.3f} px away" if name != "the minimum" else name)
    axis.axis("off")
plt.show()
assert distance(swept[100]) > 0.1 * np.sqrt(np.mean(np.sum(goal**2, axis=0)))

# %% [markdown]
# Ten sweeps have found the edges and nothing between them; a hundred are still a good part of the flow away.
#
# ## Why sweeps are slow
#
# A sweep averages. What is rough in the error, from pixel to pixel, is averaged away at once; a wave a
# hundred pixels long hardly notices that anyone looked at its neighbours. The error after some sweeps, by
# wavelength:


# %%
def by_wavelength(error):
    """Root mean square of the error in bands of wavelength [px]."""
    power = sum(np.abs(np.fft.fft2(part)) ** 2 for part in error) / error[0].size ** 2
    fv, fu = np.meshgrid(np.fft.fftfreq(error.shape[1]), np.fft.fftfreq(error.shape[2]), indexing="ij")
    frequency = np.hypot(fu, fv)
    edges = np.geomspace(1 / 300, 0.5, 15)
    bands = np.digitize(frequency, edges)
    level = np.array([np.sqrt(power[bands == k].sum()) for k in range(1, len(edges))])
    return 1 / np.sqrt(edges[1:] * edges[:-1]), level


figure, axes = plt.subplots(1, 2, figsize=(10, 3))
start = by_wavelength(-goal)[1]
for n, flow in swept.items():
    length, level = by_wavelength(flow - goal)
    axes[0].loglog(length, level / start, "o-", markersize=3, label=f"{n} sweep{'s' * (n > 1)}")
axes[0].set(
    xlabel="wavelength of the error [px]", ylabel="what is left of it", title="Sweeps: the long waves stay"
)
axes[0].legend()
grids = Multigrid(first.shape, np.float64)
grids.take(FlowEquations(x, y, t, ALPHA))
grids.start_from(np.zeros_like(goal))
cycles = [grids.flow.copy()]
for _ in range(3):
    grids.improve(grids.correction())
    cycles.append(grids.flow.copy())
for k in (1, 2, 3):
    length, level = by_wavelength(cycles[k] - goal)
    axes[1].loglog(length, level / start, "o-", markersize=3, label=f"{k} cycle{'s' * (k > 1)}")
axes[1].set(
    xlabel="wavelength of the error [px]",
    title="Multigrid from zero: all waves alike",
    ylim=axes[0].get_ylim(),
)
axes[1].legend()
plt.show()
length, level = by_wavelength(swept[1000] - goal)
left = level / start
print(
    f"1000 sweeps leave {left[length < 4].mean():.3f} of the shortest waves, "
    f"{left[length > 100].mean():.2f} of the longest"
)
assert left[length > 100].mean() > 20 * left[length < 4].mean()
rate = distance(cycles[3]) / distance(cycles[2])
print(f"each multigrid cycle leaves {rate:.2f} of the error")
assert rate < 0.35

# %% [markdown]
# On a grid of half the resolution a wave of a hundred pixels is one of fifty, on the next of twenty-five:
# there a sweep sees it. Multigrid smooths, carries what is left to the coarser grid, solves there (by doing
# the same), and brings the correction back. All waves shrink alike, whatever the size of the picture.
# Starting on the coarsest grid (full multigrid) saves the first cycles as well.
#
# ## Distance against time


# %%
def timed(run, repeats=3):
    """Fastest of some runs [ms], and the answer."""
    best = np.inf
    for _ in range(repeats):
        begun = time.process_time()
        answer = run()
        best = min(best, time.process_time() - begun)
    return 1000 * best, answer


by_sweeps = [
    timed(lambda n=n: horn_schunck_sweeps(first, second, alpha=ALPHA, sweeps=n), 1 if n > 100 else 3)
    for n in (1, 3, 10, 30, 100, 300, 1000)
]
memory = Multigrid(first.shape)
TOLERANCES = (0.1, 0.01, 0.002, 0.0005)  # zero, one, two and three cycles
by_grids = [
    timed(lambda e=e: horn_schunck(first, second, alpha=ALPHA, tolerance_px=e, grids=memory))
    for e in TOLERANCES
]
figure, axis = plt.subplots(figsize=(7, 3.2))
axis.loglog(
    [ms for ms, _ in by_sweeps],
    [distance(flow) for _, flow in by_sweeps],
    "o-",
    color="C5",
    label="sweeps, 1 to 1000",
)
axis.loglog([ms for ms, _ in by_grids], [distance(m.flow) for _, m in by_grids], "o-", label="multigrid")
axis.set(
    xlabel="time on one core [ms]",
    ylabel="distance from the minimum [px rms]",
    title=f"{camera.width} × {camera.height} pixels",
)
axis.legend()
plt.show()
ms_100, ms_grids = by_sweeps[4][0], by_grids[1][0]
print(f"100 sweeps: {ms_100:.0f} ms, {distance(by_sweeps[4][1]):.3f} px away")
print(f"multigrid:  {ms_grids:.0f} ms, {distance(by_grids[1][1].flow):.4f} px away")
assert distance(by_grids[1][1].flow) < 0.01 < distance(by_sweeps[6][1])
assert ms_grids < ms_100 / 2

# %% [markdown]
# It also knows where it stands: the solver estimates its own distance from the minimum and stops when that
# is small enough, instead of after a number of sweeps.

# %%
for e, (_, m) in zip(TOLERANCES, by_grids, strict=True):
    print(f"asked for {e:6.4f} px: {m.cycles} cycles, says {m.distance_px:.4f}, is {distance(m.flow):.4f}")
    assert distance(m.flow) < e

# %% [markdown]
# ## Is the minimum right?
#
# The minimum of an energy is not the truth. For small motions it is near, up to the borders of things, where
# the truth jumps and smoothness cannot. Large motions break the linear equation. `estimate_flow` therefore
# solves it again and again on a pyramid, the second picture warped back each time, and lets the flow break
# where it must. Here beside OpenCV's, over the pixels that stay visible:


# %%
def farneback(a, b):
    return cv2.calcOpticalFlowFarneback(a, b, np.zeros((*a.shape, 2), np.float32), 0.5, 5, 15, 3, 5, 1.2, 0)


dis = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
ours = FlowEstimator()
methods = {
    "100 sweeps": lambda a, b: np.moveaxis(horn_schunck_sweeps(a, b, alpha=ALPHA), 0, -1),
    "minimum (multigrid)": lambda a, b: np.moveaxis(
        horn_schunck(a, b, alpha=ALPHA, grids=memory).flow, 0, -1
    ),
    "estimate_flow": lambda a, b: np.moveaxis(ours(a, b).flow, 0, -1),
    "OpenCV DIS medium": lambda a, b: dis.calc(a, b, None),
    "OpenCV Farnebäck": farneback,
}
rows, shown = {}, {}
print(f"{'':22s}{'small motion':>14s}{'large motion':>14s}{'time':>9s}")
for name, method in methods.items():
    errors = []
    for other, true in ((second, small), (far, large)):
        ms, flow = timed(lambda m=method, o=other: m(first, o), 2)
        errors.append(flow_error(flow, true.flow_px, ~true.occluded).endpoint_px)
    shown[name] = flow
    rows[name] = (*errors, ms)
    print(f"{name:22s}{errors[0]:11.3f} px{errors[1]:11.3f} px{ms:6.0f} ms")

# %%
figure, axes = plt.subplots(2, 3, figsize=(10, 4.6))
pictures = {"truth": large.flow_px, **shown}
for axis, (name, flow) in zip(axes.flat, pictures.items(), strict=True):
    axis.imshow(colours(np.asarray(flow, np.float32), 25))
    axis.set_title(name if name == "truth" else f"{name}: {rows[name][1]:.2f} px")
    axis.axis("off")
figure.suptitle("Large motion")
plt.show()
assert rows["minimum (multigrid)"][0] < rows["100 sweeps"][0]
assert rows["estimate_flow"][1] < rows["minimum (multigrid)"][1] / 5
assert rows["estimate_flow"][0] < min(rows["OpenCV DIS medium"][0], rows["OpenCV Farnebäck"][0])
