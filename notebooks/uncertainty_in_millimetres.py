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
# # What calibration uncertainty means in millimetres
#
# A calibration ends with numbers such as "fx = 929.1 ± 0.4". Is that good? The question a robot asks is
# another one: *if I measure an object on the table with this camera, how many millimetres will I be off?*
# Here the covariance of a calibration is carried, step by step, from parameters to pixels to millimetres,
# and at each step checked against the only judge there is: doing it all again, many times, with new noise.

# %%
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import BoundaryNorm

import vision_robot as vr
from vision_robot.calibrate import calibrate
from vision_robot.calibrate.boards import Chessboard
from vision_robot.calibrate.judgement.projection_uncertainty import (
    expected_error,
    picture_grid,
    projection_sigma,
    worst_sigma,
)
from vision_robot.evaluate.projection import fitted_rotation, projection_difference, projection_error
from vision_robot.extrinsics.plane import fit_plane
from vision_robot.geometry import SE3, KnownCamera, WorkPlane
from vision_robot.sim.viewpoints import board_poses

plt.style.use("look.mplstyle")

# %% [markdown]
# ## A cell to be wrong about
#
# A camera looks down on a table. Nothing is rendered here: corners are computed from the truth and given 0.2
# px of noise per axis, what a good detector leaves on ordinary photos. Thirteen views of the board calibrate
# the camera, one more of the board lying on the table tells where the table is.

# %%
NOISE_PX = 0.2
SIZE = (1280, 960)
truth = vr.Camera(
    *SIZE, 929.0, 927.0, 645.0, 470.0, model="brown5", distortion=(-0.21, 0.08, 4e-4, -3e-4, -0.01)
)
board = Chessboard(9, 6, 0.025)
left, top = board.points[:, :2].min(axis=0) - 0.025
right, bottom = board.points[:, :2].max(axis=0) + 0.025
poses = board_poses(truth, (left, top, right, bottom), 13, seed=3)

tilt = np.radians(180 - 35)  # the camera looks down, 35 degrees off the vertical
cam_from_station = SE3.from_rotvec(np.array([tilt, 0, 0]), np.array([0.0, 0.05, 0.70]))
station_from_board = SE3(np.diag([1.0, -1.0, -1.0]), np.array([-0.1, 0.0625, 0.0]))


def seen(pose, rng, name):
    """The board's corners as a detector would report them."""
    pixels = truth.project(pose.apply(board.points))
    return vr.Corners(name, np.arange(len(pixels)), pixels + NOISE_PX * rng.normal(size=pixels.shape))


def calibrated(rng, views=None):
    """One whole calibration from new noise."""
    chosen = range(len(poses)) if views is None else views
    return calibrate([seen(poses[i], rng, f"view {i}") for i in chosen], board.points, SIZE)


rng = np.random.default_rng(0)
result = calibrated(rng)
print(f"rms {result.rms_px:.3f} px, noise found {result.noise_px:.3f} px per axis (truth {NOISE_PX})")
for name, sigma in result.sigma.items():
    i = truth.parameter_names.index(name)
    print(f"{name:3s} {result.camera.parameters[i]:10.4f} ± {sigma:.4f}   truth {truth.parameters[i]:9.4f}")

# %% [markdown]
# The rms says how well the corners were fitted, and nothing about fx. It would be the same had all boards
# been held still, and fx unknown.
#
# ## First check: do the ± mean what they say?
#
# Calibrate a hundred and fifty times from new noise. An honest 95 % interval holds the truth in 95 of 100
# runs, for each parameter.

# %%
RUNS = 150
runs = [calibrated(np.random.default_rng([1, k])) for k in range(RUNS)]
free = list(result.sigma)
at = [truth.parameter_names.index(name) for name in free]
off = np.array([run.camera.parameters[at] - truth.parameters[at] for run in runs])
told = np.array([[run.sigma[name] for name in free] for run in runs])
z = off / told

figure, axes = plt.subplots(1, 2, figsize=(10, 3))
axes[0].hist(z.ravel(), bins=np.linspace(-4, 4, 41), density=True, color="C0", alpha=0.6)
x = np.linspace(-4, 4, 200)
axes[0].plot(x, np.exp(-(x**2) / 2) / np.sqrt(2 * np.pi), color="C1", label="normal, sigma 1")
axes[0].set(
    xlabel="(estimate − truth) / stated sigma", title=f"All parameters of {RUNS} calibrations", yticks=[]
)
axes[0].legend()
inside = np.mean(np.abs(z) < 1.96, axis=0)
axes[1].bar(free, 100 * inside, color="C0", alpha=0.7)
axes[1].axhline(95, color="C1")
axes[1].set(ylim=(80, 100), ylabel="%", title="How often the 95 % interval held the truth")
plt.show()
print(f"over all parameters: {100 * inside.mean():.1f} %")
assert 0.92 < inside.mean() < 0.98
assert inside.min() > 0.88

# %% [markdown]
# ## From parameters to pixels
#
# Errors of fx, cx and k1 hang together: they were found from the same corners and make up for each other
# where the boards were. So no single ± answers "where does this point land?"; the whole covariance does,
# through the derivative of the projection. What remains is a map over the picture. Left what one calibration
# foretells of itself, right what a hundred and fifty calibrations really scattered (points far away, the
# best common rotation taken out, since no camera knows how it sits in its housing).

# %%
grid = picture_grid(truth, 33, 25)
foretold = projection_sigma(result, grid)
differences = np.array(
    [
        projection_difference(run.camera, truth, grid, rotation=fitted_rotation(run.camera, truth))
        for run in runs
    ]
)
scatter = np.einsum("khwi,khwj->hwij", differences, differences) / RUNS
happened = worst_sigma(scatter)

figure, axes = plt.subplots(1, 3, figsize=(10, 2.9))
levels = [0, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2]
for axis, values, title in zip(
    axes, (foretold, happened), ("foretold by one", f"happened in {RUNS}"), strict=False
):
    bands = axis.contourf(
        grid[..., 0], grid[..., 1], values, levels=levels, cmap="Blues", norm=BoundaryNorm(levels, 256)
    )
    axis.set(title=f"{title} [px, 1 sigma]", aspect="equal", ylim=(SIZE[1], 0), xlabel="u [px]")
figure.colorbar(bands, ax=axes[:2], shrink=0.8)
corners_seen = np.concatenate([view.pixels for view in result.corners])
axes[0].plot(*corners_seen.T, ",", color="C1")
axes[2].plot(foretold.ravel(), happened.ravel(), ".", markersize=3)
axes[2].axline((0, 0), slope=1, color="C1")
axes[2].set(xlabel="foretold [px]", ylabel="happened [px]", title="one dot for each place")
plt.show()
ratio = np.sqrt(np.mean(happened**2) / np.mean(foretold**2))
print(f"happened / foretold = {ratio:.2f}")
assert 0.85 < ratio < 1.15
expected = expected_error(result)
measured = projection_error(result.camera, truth, fit_rotation=True).rms_px
print(
    f"this calibration expects {expected.expected_px:.3f} px rms over the picture "
    f"(95 %: {expected.low_px:.3f} to {expected.high_px:.3f}); it is {measured:.3f} px off"
)
assert expected.low_px < measured < expected.high_px

# %% [markdown]
# The map is dark where no corner was (dots): that is where the answer is extrapolated, and where to hold the
# board next.
#
# ## From pixels to millimetres
#
# Now the table. Its pose is found from one view of the board with the *calibrated* camera, so the camera's
# error is in the pose as well, and the two largely cancel on the table. `WorkPlane` keeps both in one
# covariance, cross terms included. Its `measure` gives each position with a 2×2 covariance.


# %%
def plane_of(result, rng):
    """The work plane as a user gets it, and its covariance together with the camera's."""
    known = KnownCamera(result.camera, result.covariance.intrinsics)
    view = seen(cam_from_station @ station_from_board, rng, "table")
    return fit_plane(known, [view], board.points, station_from_board).plane


plane = plane_of(result, rng)
places = np.stack(np.meshgrid(np.linspace(-0.24, 0.24, 13), np.linspace(-0.15, 0.15, 9)), axis=-1)
true_plane = WorkPlane.exact(truth, cam_from_station)
pixels = true_plane.pixels(places.reshape(-1, 2))
assert truth.sees(
    cam_from_station.apply(np.column_stack([places.reshape(-1, 2), np.zeros(places[..., 0].size)]))
).all()

_, covariance = plane.measure(pixels)  # of camera and plane alone, the pixel taken as exact
sigma_mm = 1000 * worst_sigma(covariance).reshape(places.shape[:-1])


def errors_of(planes, pixels, z_m=0.0):
    """Where each plane puts the pixels, less where they are [mm]."""
    return 1000 * np.array([p.measure(pixels, z_m=z_m)[0] - places.reshape(-1, 2) for p in planes])


planes = [plane_of(run, np.random.default_rng([2, k])) for k, run in enumerate(runs)]
errors = errors_of(planes, pixels)
happened_mm = worst_sigma(np.einsum("kni,knj->nij", errors, errors) / RUNS).reshape(places.shape[:-1])

# %%
figure, axes = plt.subplots(1, 3, figsize=(10, 2.8))
x_mm, y_mm = 1000 * places[..., 0], 1000 * places[..., 1]
for axis, values, title in zip(
    axes, (sigma_mm, happened_mm), ("foretold by one", f"happened in {RUNS}"), strict=False
):
    bands = axis.contourf(x_mm, y_mm, values, levels=np.linspace(0, 0.24, 9), cmap="Blues")
    on_table = 1000 * station_from_board.apply(board.points)
    axis.plot(on_table[:, 0], on_table[:, 1], ",", color="C1")
    axis.set(title=f"{title} [mm, 1 sigma]", aspect="equal", xlabel="x [mm]")
axes[0].set_ylabel("y [mm]")
figure.colorbar(bands, ax=axes[:2], shrink=0.7)
some = slice(0, 12)
for k in range(some.stop):
    axes[2].quiver(
        x_mm[::2, ::2],
        y_mm[::2, ::2],
        *(errors[k].reshape(*places.shape)[::2, ::2].transpose(2, 0, 1)),
        angles="xy",
        scale_units="xy",
        scale=1 / 150,
        width=0.004,
        color=plt.get_cmap("tab20")(k),
        alpha=0.7,
    )
axes[2].set(title="12 cells' errors, × 150", aspect="equal", xlabel="x [mm]")
plt.show()
ratio_mm = np.sqrt(np.mean(happened_mm**2) / np.mean(sigma_mm**2))
print(f"sigma on the table: {sigma_mm.min():.3f} to {sigma_mm.max():.3f} mm")
print(f"happened / foretold = {ratio_mm:.2f}")
assert 0.85 < ratio_mm < 1.15

# %% [markdown]
# Each colour of the right panel is one calibrated cell: a cell's errors are a smooth bend of the whole
# table, not noise from place to place. Averaging more measurements does not help against it, and a *length*
# between near points is much better known than their positions.
#
# ## What if one looks at the parts?
#
# The tempting shortcuts, beside what happened: camera and plane as if independent of each other, and the
# camera taken as exact. With one photo of the table as above; with six, the board moved about, wherever it
# lies; and with six, for places 150 mm above the table.

# %%
elsewhere = [
    (0.12, -0.05, 0.4),
    (-0.2, -0.06, -0.3),
    (0.02, 0.12, 2.0),
    (-0.22, 0.13, 0.2),
    (0.06, 0.14, 0.1),
]
laid = [station_from_board]
for x, y, yaw in elsewhere:
    turn = SE3.from_rotvec(np.array([0, 0, yaw]), np.array([x, y, 0.0]))
    laid.append(turn @ SE3(np.diag([1.0, -1.0, -1.0]), np.zeros(3)))


def plane_from(known, photos, rng):
    """The plane from so many photos of the board on the table, the noise of corners being known."""
    views = [seen(cam_from_station @ place, rng, f"table {k}") for k, place in enumerate(laid[:photos])]
    return fit_plane(known, views, board.points, station_from_board, sigma_px=NOISE_PX).plane


def rms_mm(covariance):
    """Over the table, in the worst direction of each place."""
    return float(1000 * np.sqrt(np.mean(worst_sigma(covariance) ** 2)))


def known_by(run):
    return KnownCamera(run.camera, run.covariance.intrinsics)


p = len(truth.parameters)
some = runs[:50]
heights = {}
for photos, z_m, title in ((1, 0, "1 photo"), (6, 0, "6 photos"), (6, 0.15, "6 photos, 150 mm above")):
    at_px = true_plane.pixels(places.reshape(-1, 2), z_m=z_m)
    many = [plane_from(known_by(run), photos, np.random.default_rng([6, k])) for k, run in enumerate(some)]
    off_mm = errors_of(many, at_px, z_m)
    joint = many[0]
    no_cross = joint.covariance.copy()
    no_cross[:p, p:] = no_cross[p:, :p] = 0
    apart = WorkPlane(joint.camera, joint.cam_from_station, no_cross)
    exact = plane_from(KnownCamera.exact(result.camera), photos, np.random.default_rng(5))
    heights[title] = {
        "happened": rms_mm(1e-6 * np.einsum("kni,knj->nij", off_mm, off_mm) / len(some)),
        "joint\ncovariance": rms_mm(joint.measure(at_px, z_m=z_m)[1]),
        "as if\nindependent": rms_mm(apart.measure(at_px, z_m=z_m)[1]),
        "camera\nas exact": rms_mm(exact.measure(at_px, z_m=z_m)[1]),
    }

figure, axes = plt.subplots(1, 3, figsize=(10, 2.8), sharey=True)
for axis, (title, bars) in zip(axes, heights.items(), strict=True):
    axis.bar(list(bars), list(bars.values()), color=["C1", "C0", "C5", "C5"])
    for place, value in enumerate(bars.values()):
        axis.annotate(f"{value:.3f}", (place, value), ha="center", va="bottom", fontsize=8)
    axis.set_title(title)
axes[0].set_ylabel("mm rms over the table, 1 sigma")
plt.show()
for bars in heights.values():
    happened_rms, joint, apart, exact = bars.values()
    assert abs(joint / happened_rms - 1) < 0.25
    assert apart > 2 * happened_rms
    assert exact < joint
assert (
    heights["6 photos, 150 mm above"]["camera\nas exact"]
    < 0.95 * heights["6 photos, 150 mm above"]["joint\ncovariance"]
)
assert heights["6 photos"]["happened"] < 0.7 * heights["1 photo"]["happened"]

# %% [markdown]
# Taking the parts as independent cries wolf, seven times and more: on the table the camera's error and that
# of the pose found with it cancel nearly whole. That is also why taking the camera as exact goes almost
# unpunished here, and begins to be too bold away from the board, 150 mm above the table. The joint
# covariance is right in all three. And it tells where to work: five more photos of the table nearly halve
# the error, which no better calibration would.
#
# ## A measured object
#
# Add the pixel's own noise, say 0.3 px of a tracker, and the height of the object's top, known to half a
# millimetre:

# %%
target_px = np.array([[400.0, 380.0], [1180.0, 860.0]])
positions, covariance = plane.measure(target_px, 0.3, z_m=0.008, sigma_z_m=0.0005)
for pixel, place, C in zip(target_px, positions, covariance, strict=True):
    sx, sy = 1000 * np.sqrt(np.diag(C))
    print(f"pixel {pixel} -> ({1000 * place[0]:7.2f} ± {sx:.2f}, {1000 * place[1]:7.2f} ± {sy:.2f}) mm")
parts = {
    "camera and plane": plane.measure(target_px[1:], z_m=0.008)[1],
    "pixel, 0.3 px": WorkPlane.exact(plane.camera, plane.cam_from_station).measure(
        target_px[1:], 0.3, z_m=0.008
    )[1],
    "height, 0.5 mm": WorkPlane.exact(plane.camera, plane.cam_from_station).measure(
        target_px[1:], z_m=0.008, sigma_z_m=0.0005
    )[1],
}
for name, C in parts.items():
    print(f"  of the second, {name:17s} {1000 * worst_sigma(C)[0]:.3f} mm")
total = sum(parts.values())
assert np.allclose(total, covariance[1:])

# %% [markdown]
# Variances add up, so the largest part rules: here it is worth more to measure the height than to calibrate
# better. `vr measure` prints the same numbers from the files of `vr calibrate` and `vr extrinsics plane`.
#
# ## How many views are enough?
#
# The same question to the covariance, for calibrations from 4 to 13 views, the table photographed once or
# six times:

# %%
counts = (4, 5, 6, 8, 10, 13)
figure, axis = plt.subplots(figsize=(6, 2.8))
curves = {}
for photos in (1, 6):
    curves[photos] = [
        np.mean(
            [
                rms_mm(
                    plane_from(
                        known_by(calibrated(np.random.default_rng([3, n, k]), range(n))),
                        photos,
                        np.random.default_rng([4, k]),
                    ).measure(pixels)[1]
                )
                for k in range(4)
            ]
        )
        for n in counts
    ]
    axis.plot(counts, curves[photos], "o-", label=f"{photos} of the table")
axis.set(xlabel="views of the calibration", ylabel="mm on the table, 1 sigma", ylim=(0, None))
axis.legend()
plt.show()
assert curves[6][-1] < curves[1][-1]
assert curves[6][-1] < curves[6][0]

# %% [markdown]
# There is no number of views that is enough: there is a number of millimetres that is, and this is how to
# ask for it. `vr calibrate` and `vr extrinsics plane --report` draw these maps for your own cell.
