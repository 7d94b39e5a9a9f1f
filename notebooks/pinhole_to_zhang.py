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
# # From the pinhole to Zhang, step by step
#
# How do a few pictures of a flat board tell what a camera is? Four steps, each a dozen lines of numpy beside
# the library's own function for it: the pinhole, a homography for each picture, Zhang's closed form (2000),
# and the refinement that ends with a standard deviation for every number. First on rendered boards, whose
# camera is known, then on fourteen real photos.

# %%
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import mvtbdata
import numpy as np

import vision_robot as vr
from vision_robot.calibrate import calibrate
from vision_robot.calibrate.homography import apply_homography, fit_homographies
from vision_robot.calibrate.zhang import closed_form_intrinsics, closed_form_poses, closed_form_radial
from vision_robot.evaluate.projection import projection_error
from vision_robot.geometry import SE3, rotation_exp, skew
from vision_robot_synth.calibration import TRUTH, calibration_set

np.set_printoptions(suppress=True, precision=4)
plt.style.use("look.mplstyle")

# %% [markdown]
# ## The pinhole
#
# A point X of the board goes into the camera's frame, is divided by its depth, and becomes a pixel:
# $\;s\,(u, v, 1)^T = K\,[R\ t]\,(X, Y, Z, 1)^T$. Ten pictures are rendered with a camera of which everything
# is known. It is no pinhole: its lens bends lines outwards in (barrel), which will matter soon.

# %%
half = 0.5  # of the resolution of the library's standard synthetic camera
true = replace(TRUTH, width=640, height=480, fx=TRUTH.fx * half, fy=TRUTH.fy * half)
true = replace(true, cx=(TRUTH.cx + 0.5) * half - 0.5, cy=(TRUTH.cy + 0.5) * half - 0.5)
rendered = calibration_set(true, views=10, seed=4)
pictures = list(rendered.images())
board = rendered.board
print(true)

X = board.points[0]  # the first corner, in the board's frame
pose = rendered.cam_from_board[0]
P = true.K @ np.column_stack([pose.rotation, pose.translation])
u, v, s = P @ [*X, 1]
print("by the pinhole ", np.array([u, v]) / s)
print("with the lens  ", true.project(pose.apply(X[None]))[0])

# %%
seen = vr.detect_boards({f"view {i}": picture for i, picture in enumerate(pictures)}, board)
views = [view for view in seen if view is not None]
assert len(views) == 10
pixels = np.stack([view.pixels[np.argsort(view.ids)] for view in views])  # (views, corners, 2)

figure, axes = plt.subplots(1, 4, figsize=(10, 2.1))
for axis, picture, corners in zip(axes.flat, pictures[3:7], pixels[3:7], strict=True):
    axis.imshow(picture[::2, ::2], vmin=0, vmax=255, extent=(-0.5, 639.5, 479.5, -0.5))
    axis.plot(*corners.T, ".", color="C1", markersize=2)
    axis.axis("off")
figure.suptitle("What the camera saw, and the corners found in it: four of ten")
plt.show()

detection = np.sqrt(np.mean((pixels - rendered.corners) ** 2))
print(f"corners are off by {detection:.3f} px rms per axis: a picture of the truth, not the truth")
assert detection < 0.05

# %% [markdown]
# ## One homography for each picture
#
# On the board Z = 0, so the third column of R drops out and $H = K\,[r_1\ r_2\ t]$ is a 3×3 matrix up to
# scale. Each corner gives two equations that are linear in its nine numbers; the singular vector of the
# least singular value solves them (with both sides first brought near 1: Hartley's normalisation).


# %%
def homography(plane, image):
    """The direct linear transform: H with image ~ H plane."""

    def near_one(points):
        centre, spread = points.mean(axis=0), points.std()
        return (points - centre) / spread, np.array(
            [[1 / spread, 0, -centre[0] / spread], [0, 1 / spread, -centre[1] / spread], [0, 0, 1]]
        )

    (p, Tp), (q, Tq) = near_one(plane), near_one(image)
    one, zero = np.ones(len(p)), np.zeros((len(p), 3))
    ph = np.column_stack([p, one])
    A = np.concatenate(
        [np.hstack([ph, zero, -q[:, :1] * ph]), np.hstack([zero, ph, -q[:, 1:] * ph])]
    )  # two rows for each corner
    H = np.linalg.svd(A)[2][-1].reshape(3, 3)
    return np.linalg.inv(Tq) @ H @ Tp


plane = np.broadcast_to(board.points[:, :2], pixels.shape)
by_hand = np.stack([homography(p, q) for p, q in zip(plane, pixels, strict=True)])
H = fit_homographies(plane, pixels, np.ones(pixels.shape[:2]))  # the library's: descends on pixels after that
error = {
    name: np.sqrt(np.mean(np.sum((apply_homography(h, plane) - pixels) ** 2, axis=-1), axis=-1))
    for name, h in (("direct linear", by_hand), ("refined", H))
}
for name, rms in error.items():
    print(f"{name:14s} {np.mean(rms):.4f} px rms in the mean")
assert np.all(error["refined"] <= error["direct linear"])

# %% [markdown]
# What is left is not noise. A homography keeps lines straight, the lens does not: the arrows (30 times their
# length) turn together, and more towards the edge of the picture.

# %%
left = apply_homography(H, plane) - pixels
figure, axes = plt.subplots(1, 3, figsize=(10, 2.9))
for axis, k in zip(axes, np.argsort(error["refined"])[[0, 5, 9]], strict=True):
    axis.imshow(pictures[k][::2, ::2], vmin=0, vmax=600, alpha=0.35, extent=(-0.5, 639.5, 479.5, -0.5))
    axis.quiver(
        *pixels[k].T, *left[k].T, color="C1", angles="xy", scale_units="xy", scale=1 / 30, width=0.005
    )
    axis.set(title=f"view {k}: {error['refined'][k]:.2f} px rms", xlim=(0, 640), ylim=(480, 0))
    axis.axis("off")
plt.show()
assert np.mean(error["refined"]) > 5 * detection

# %% [markdown]
# ## Zhang's closed form
#
# $r_1$ and $r_2$ are at right angles and of equal length. With $B = K^{-T} K^{-1}$ that says of every
# homography $h_1^T B\, h_2 = 0$ and $h_1^T B\, h_1 = h_2^T B\, h_2$: two linear equations in the six numbers
# of B. Three pictures make six, and K follows from B by its Cholesky factor.


# %%
def intrinsics(homographies, unit):
    """K from the homographies; `unit` brings pixels near 1."""

    def row(h, i, j):
        a, b = h[:, i], h[:, j]
        return [
            a[0] * b[0],
            a[0] * b[1] + a[1] * b[0],
            a[1] * b[1],
            a[0] * b[2] + a[2] * b[0],
            a[1] * b[2] + a[2] * b[1],
            a[2] * b[2],
        ]

    rows = []
    for H_n in unit @ homographies:
        h = H_n / np.linalg.norm(H_n)
        rows += [row(h, 0, 1), np.subtract(row(h, 0, 0), row(h, 1, 1))]
    b = np.linalg.svd(np.array(rows))[2][-1]
    B = np.array([[b[0], b[1], b[3]], [b[1], b[2], b[4]], [b[3], b[4], b[5]]])
    L = np.linalg.cholesky(B if b[0] > 0 else -B)  # B = L L^T, and K = L^-T up to scale
    K = np.linalg.inv(L.T)
    return np.linalg.inv(unit) @ (K / K[2, 2])


size = (true.width, true.height)
reach = np.hypot(*size) / 2
unit = np.array([[1, 0, -(size[0] - 1) / 2], [0, 1, -(size[1] - 1) / 2], [0, 0, reach]]) / reach
K_by_hand = intrinsics(H, unit)
K_zhang = closed_form_intrinsics(H, size, skew=True)
print("by hand", K_by_hand, "the library's", K_zhang, "the truth", true.K, sep="\n")
assert np.allclose(K_by_hand, K_zhang, rtol=1e-8, atol=1e-6)

# %% [markdown]
# The same to the last digit, and both off by seven pixels in fx and nine in cx: the closed form believes in
# a pinhole, so it takes what the lens does for something K does. Feed it corners with the lens's bend taken
# out and it is right:

# %%
straight = true.undistorted_pixels(pixels)
K_straight = closed_form_intrinsics(
    fit_homographies(plane, straight, np.ones(pixels.shape[:2])), size, skew=True
)
print(K_straight)
off = abs(K_zhang[0, 0] - true.fx), abs(K_straight[0, 0] - true.fx)
print(f"fx off by {off[0]:.1f} px with the lens, {off[1]:.2f} px without")
assert off[0] > 10 * off[1]

# %% [markdown]
# ## Poses, and a first idea of the lens
#
# With K known, the columns of $K^{-1}H$ are $r_1$, $r_2$ and t up to one scale; the nearest rotation cleans
# them up. What the pinhole then leaves over grows with r² and r⁴ and is linear in k1 and k2 (Zhang's
# equation 13).

# %%
K0 = closed_form_intrinsics(H, size, skew=False)
poses = closed_form_poses(K0, H)
k1, k2 = closed_form_radial(K0, poses.apply(board.points), pixels, np.ones(pixels.shape[:2]))
start = vr.Camera(*size, K0[0, 0], K0[1, 1], K0[0, 2], K0[1, 2], model="brown5", distortion=(k1, k2, 0, 0, 0))


def rms_px(camera, poses):
    """Per point, both axes together."""
    return np.sqrt(np.mean(np.sum((camera.project(poses.apply(board.points)) - pixels) ** 2, axis=-1)))


print(f"k1 = {k1:.3f} (truth {true.distortion[0]}), k2 = {k2:.3f} (truth {true.distortion[1]})")
assert abs(k1) < 0.1
print(
    f"{rms_px(start.without_distortion(), poses):.2f} px rms as a pinhole, "
    f"{rms_px(start, poses):.2f} px with k1, k2"
)

# %% [markdown]
# Nearly nothing: K and the poses have already bent themselves to the lens, and what they left over tells
# little about it. The closed form is a start, not an answer.

# %% [markdown]
# ## Refinement
#
# All numbers at once, those of the camera and six for every pose, moved until the sum of squared distances
# in the pictures is least. Gauss–Newton in plain numpy: project, differentiate, solve, repeat. A pose moves
# by a small turn w and shift dt, $R \leftarrow \exp(w)R$, so that no Euler angles are needed.


# %%
def refine(camera, poses, steps=8):
    """Gauss-Newton over nine intrinsics (no skew) and all poses; the last normal matrix, and every rms."""
    free = [0, 1, 2, 3, 5, 6, 7, 8, 9]  # all parameters but skew
    n_views, history = len(poses), []
    for _ in range(steps):
        J = np.zeros((*pixels.shape, len(free) + 6 * n_views))
        turned = board.points @ np.swapaxes(poses.rotation, -1, -2)
        in_cam = turned + poses.translation[:, None]
        residual = np.zeros_like(pixels)
        for i in range(n_views):
            projected, in_point, in_parameters = camera.project_jacobian(in_cam[i])
            residual[i] = projected - pixels[i]
            J[i, :, :, : len(free)] = in_parameters[:, :, free]
            at = len(free) + 6 * i
            J[i, :, :, at : at + 3] = -in_point @ skew(turned[i])  # d(exp(w) R X)/dw
            J[i, :, :, at + 3 : at + 6] = in_point
        J, r = J.reshape(-1, J.shape[-1]), residual.ravel()
        history.append(np.sqrt(2 * np.mean(r**2)))
        scale = 1 / np.linalg.norm(J, axis=0)
        step = -scale * np.linalg.lstsq(J * scale, r, rcond=None)[0]
        parameters = camera.parameters.copy()
        parameters[free] += step[: len(free)]
        camera = camera.with_parameters(parameters)
        moves = step[len(free) :].reshape(-1, 6)
        poses = SE3(rotation_exp(moves[:, :3]) @ poses.rotation, poses.translation + moves[:, 3:])
    noise = np.sqrt(np.sum(r**2) / (len(r) - J.shape[1]))
    sigma = noise * np.sqrt(np.diag(np.linalg.inv((J * scale).T @ (J * scale)))) * scale
    return camera, poses, history, sigma[: len(free)], noise


camera, refined_poses, history, sigma, noise = refine(start, poses)
print(f"rms {history[0]:.3f} -> {history[-1]:.4f} px; noise per axis {noise:.4f} px")

# %% [markdown]
# The library does the same by Levenberg–Marquardt with the poses eliminated first, weighs corners by their
# own precision, leaves out what noise cannot explain, and refuses what the views do not tell. Here all three
# agree: by hand, the library, and the truth within two standard deviations or so.

# %%
result = calibrate(views, board.points, size, vr.Settings(model="brown5"))
names = list(result.sigma)
library = dict(zip(result.camera.parameter_names, result.camera.parameters, strict=True))
truth = dict(zip(true.parameter_names, true.parameters, strict=True))
ours = dict(zip(camera.parameter_names, camera.parameters, strict=True))
begun = dict(zip(start.parameter_names, start.parameters, strict=True))

print(
    f"{'':4s}{'closed form':>13s}{'by hand':>11s}{'vr':>11s}"
    f"{'+- sigma':>10s}{'truth':>11s}{'off, sigmas':>13s}"
)
offs = {}
for name in names:
    offs[name] = (library[name] - truth[name]) / result.sigma[name]
    print(
        f"{name:4s}{begun[name]:13.4f}{ours[name]:11.4f}{library[name]:11.4f}{result.sigma[name]:10.4f}"
        f"{truth[name]:11.4f}{offs[name]:13.1f}"
    )
assert max(map(abs, offs.values())) < 3.5
assert abs(ours["fx"] - library["fx"]) < 3 * result.sigma["fx"]

# %%
figure, (left_axis, right_axis) = plt.subplots(1, 2, figsize=(10, 3))
left_axis.semilogy(history, "o-")
left_axis.axhline(np.sqrt(2) * detection, color="C1", linestyle="--", label="noise of the corners")
left_axis.set(
    xlabel="Gauss–Newton step", ylabel="rms [px]", title="From the closed form to the noise in three steps"
)
left_axis.legend()
stages = {
    "closed form,\npinhole": start.without_distortion(),
    "with k1, k2": start,
    "refined\nby hand": camera,
    "vr": result.camera,
}
distance = [projection_error(c, true, fit_rotation=True).rms_px for c in stages.values()]
right_axis.bar(list(stages), distance, color=["C5", "C5", "C0", "C0"])
right_axis.set_yscale("log")
right_axis.set(ylabel="px rms over the whole picture", title="How far each camera is from the true one")
for place, value in enumerate(distance):
    right_axis.annotate(f"{value:.2g}", (place, value), ha="center", va="bottom", fontsize=8)
plt.show()
assert history[3] < 1.05 * history[-1]
assert distance[3] < 0.1 < distance[1] < distance[0]

# %% [markdown]
# ## How many pictures?
#
# Zhang needs three views (two without skew). More views make the answer steadier; here the closed form and
# the refined camera from the first n of the ten.

# %%
counts = range(3, 11)
closed, refined = [], []
for n in counts:
    K_n = closed_form_intrinsics(H[:n], size, skew=False)
    closed.append(np.nan if K_n is None else K_n[0, 0])
    r = calibrate(views[:n], board.points, size, vr.Settings(model="brown5"))
    refined.append((r.camera.fx, r.sigma["fx"]))
fx, sigma_fx = np.array(refined).T
figure, axes = plt.subplots(1, 2, figsize=(10, 2.8))
axes[0].plot(counts, closed, "o-", color="C5", label="closed form")
axes[0].plot(counts, fx, "o-", label="refined")
axes[0].axhline(true.fx, color="C1", linestyle="--", label="truth")
axes[0].set(xlabel="views", ylabel="fx [px]", title="The closed form is biased, not just noisy")
axes[0].legend()
axes[1].errorbar(counts, fx - true.fx, 1.96 * sigma_fx, fmt="o", capsize=3)
axes[1].axhline(0, color="C1", linestyle="--")
axes[1].set(xlabel="views", ylabel="fx − truth [px]", title="Refined, with its 95 % interval")
plt.show()
assert sigma_fx[-1] < sigma_fx[0] / 2

# %% [markdown]
# ## Fourteen real photos
#
# OpenCV's own samples, from the package `mvtb-data`. No truth here; what is left in the pictures must speak.

# %%
photos = vr.open_images(sorted((Path(mvtbdata.__file__).parent / "images" / "calibration").glob("left*.jpg")))
chessboard = vr.board_named("chessboard", (9, 6), square_m=0.025)
found = [view for view in vr.detect_boards(photos, chessboard) if view]
fits = {
    "pinhole": vr.Settings(model="pinhole"),
    "brown5": vr.Settings(model="brown5"),
    "brown5, board bent": vr.Settings(model="brown5", warp=5),
}
cameras = {name: calibrate(found, chessboard.points, size, setting) for name, setting in fits.items()}
for name, r in cameras.items():
    fx, sigma_fx = r.camera.fx, r.sigma["fx"]
    print(
        f"{name:20s} rms {r.rms_px:.3f} px   fx {fx:.2f} ± {sigma_fx:.2f}   "
        f"cy {r.camera.cy:.2f} ± {r.sigma['cy']:.2f}"
    )

# %%
figure, axes = plt.subplots(1, 3, figsize=(10, 2.9), sharey=True)
for axis, (name, r), enlarged in zip(axes, cameras.items(), (12, 120, 120), strict=True):
    where, what = np.concatenate([c.pixels for c in r.corners]), np.concatenate(r.residuals)
    axis.quiver(*where.T, *what.T, angles="xy", scale_units="xy", scale=1 / enlarged, width=0.003, color="C0")
    axis.set(
        title=f"{name}: {r.rms_px:.3f} px rms (× {enlarged})", xlim=(0, 640), ylim=(480, 0), xlabel="u [px]"
    )
axes[0].set_ylabel("v [px]")
plt.show()

rms = [r.rms_px for r in cameras.values()]
assert rms[0] > 5 * rms[1] > 5 * 2 * rms[2]
shift = abs(cameras["brown5"].camera.cy - cameras["brown5, board bent"].camera.cy)
assert shift > 5 * cameras["brown5"].sigma["cy"]

# %% [markdown]
# Left, the lens speaks: arrows along the radius. In the middle, the noise looks small, yet neighbouring
# arrows agree. The board is not flat. Estimated along with the camera (right), its bend takes away more than
# half of what was left and moves cy by several pixels, many times its stated deviation. A small rms does not
# prove a right camera: the notebook `calibrate_your_camera` shows what asks further.
