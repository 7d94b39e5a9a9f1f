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
# # The text's worked example, and its mistake
#
# The 2019 text from which this project comes calibrates a camera with MATLAB and derives a formula from
# pixels (x, y) to millimetres (X, Y) on the table, the plane Z = 0. Here its numbers are reproduced from its
# inputs, then the right mapping is set beside them.
#
# Everything stays in the text's own units and pixels: millimetres, and MATLAB's pixels, whose first has its
# centre at (1, 1). Ours are one less; `vision_robot.formats` converts when it reads the matrix.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from vision_robot.formats import read_camera
from vision_robot.geometry import SE3, pixel_grid, plane_from_pixels, plane_homography

np.set_printoptions(suppress=True, precision=4)
plt.style.use("look.mplstyle")

# %% [markdown]
# ## What the text publishes
#
# MATLAB's export. Its matrices act on row vectors, so this is the transpose of the usual K.

# %%
K_transposed = np.array([[1064, 0, 0], [-0.8118, 1065.8, 0], [258.3899, 295.171, 1]])
R = np.array([[0.9992, 0.0027, -0.0399], [-0.002, 0.9999, 0.0136], [0.0399, -0.0162, 0.9991]])
t = np.array([-226.1425, -166.5716, 1240.0])  # mm

printed = np.array([[0.0106, 0, -2.4079], [-0.0004, 0.0107, -1.7735], [0.0026, 0.0030, -1.0636]])

# %% [markdown]
# ## What the text does with it
#
# It multiplies the transposed matrix, as it stands, by [r1 r2 t], scales by 10⁻⁵, and prints the result to
# four decimals.

# %%
r1_r2_t = np.column_stack([R[:, 0], R[:, 1], t])
computed = 1e-5 * K_transposed @ r1_r2_t
agrees = np.abs(computed - printed) < 0.00005 + 1e-9
print(computed, agrees, sep="\n\n")
assert agrees.sum() == 7

# %% [markdown]
# Seven of nine entries agree to the last digit. The other two:
#
# * −2.4079 needs an fx of about 1064.8: the text computed with more digits than it prints.
# * −0.0004 comes out as −0.00003 and no rounding of the inputs changes that: most likely a slip of the pen.
#   It takes no part in the final formula.

# %%
more_digits = K_transposed.copy()
more_digits[0, 0] = 1064.76
computed = 1e-5 * more_digits @ r1_r2_t
agrees = np.abs(computed - printed) < 0.00005 + 1e-9
print(computed)
assert agrees.sum() == 8
assert not agrees[1, 0]

# %% [markdown]
# The text then leaves out the last row and the small entries and solves the first two rows for X and Y:
#
# $$X = \frac{x + 2.4079}{0.0106}, \qquad Y = \frac{y + 1.7735}{0.0107}$$


# %%
def by_the_text(pixels):
    """Millimetres by the printed formula."""
    return np.add(pixels, [2.4079, 1.7735]) / [0.0106, 0.0107]


assert np.allclose(by_the_text(np.zeros(2)), -printed[:2, 2] / np.diag(printed)[:2])

# %% [markdown]
# ## The right mapping
#
# A pixel sees the point for which $(x, y, 1) \sim K\,[r_1\ r_2\ t]\,(X, Y, 1)$, K now the transpose of
# MATLAB's matrix. The way back is the inverse of that 3×3 matrix, with its division by the third component.
# The camera is imported from MATLAB's matrix as a user would.

# %%
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "camera.m"
    rows = "; ".join(" ".join(map(str, row)) for row in K_transposed.tolist())
    path.write_text(f"IntrinsicMatrix = [{rows}];\nImageSize = [480 640];\n")
    camera = read_camera(path)
print(camera)

cam_from_table = SE3(R, t / 1000)


def rightly(pixels, cam_from_table=cam_from_table):
    """Millimetres by the inverse homography; pixels as MATLAB counts them."""
    plane_from_pixel = np.linalg.inv(plane_homography(camera.K, cam_from_table))
    ours = np.concatenate([pixels - 1, np.ones_like(pixels[..., :1])], axis=-1)
    X, Y, w = np.moveaxis(ours @ plane_from_pixel.T, -1, 0)
    return 1000 * np.stack([X / w, Y / w], axis=-1)


pixel = np.array([320.0, 240.0])
print(rightly(pixel), "mm")

# %% [markdown]
# Straight from the published matrices, without the library, it is the same, and mapping forward returns the
# pixel:

# %%
H = K_transposed.T @ r1_r2_t
X, Y, w = np.linalg.inv(H) @ [*pixel, 1]
assert np.allclose(rightly(pixel), [X / w, Y / w], rtol=0, atol=1e-9)

x, y, w = H @ [*rightly(pixel), 1]
print(np.array([x, y]) / w)
assert np.allclose([x / w, y / w], pixel)

# %% [markdown]
# ## How large the mistake is
#
# At pixel (320, 240):

# %%
error = by_the_text(pixel) - rightly(pixel)
print("by the text", by_the_text(pixel), "mm")
print("rightly    ", rightly(pixel), "mm")
print(f"error       {error} mm, {np.hypot(*error) / 1000:.1f} m")

# %% [markdown]
# The text's point lies tens of metres away, in a picture that spans three quarters of a metre of the table.
# Two mistakes are in it.
#
# **K' stands where K belongs.** The principal point sits in the third row, which is then dropped, so it
# drops out of the formula. And the scale: after 10⁻⁵ one pixel counts 1/0.0106 = 94 mm, where at 1.24 m from
# this lens it is 1.17 mm. If x and y were scaled by 10⁻⁵ too, the formula would answer (227, 166) mm for
# every pixel, to within a millimetre.
#
# **The division is dropped.** With the right K, what would be lost by this alone? Divide $K\,[r_1\ r_2\ t]$
# by its last entry, 1240 mm, and leave out the last row as the text does:

# %%
affine = H / H[2, 2]


def without_division(pixels):
    """Millimetres by the first two rows of the right matrix."""
    return np.linalg.solve(affine[:2, :2], (pixels - affine[:2, 2])[..., None])[..., 0]


grid = pixel_grid(640, 480) + 1
truth = rightly(grid)
errors = {
    "the text's formula": np.linalg.norm(by_the_text(grid) - truth, axis=-1),
    "right K, division dropped": np.linalg.norm(without_division(grid) - truth, axis=-1),
}
for name, value in errors.items():
    least, median, most = np.percentile(value, [0, 50, 100])
    print(f"{name:26s} least {least:7.1f} mm, median {median:7.1f} mm, most {most:7.1f} mm")

# %%
figure, axes = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
panels = [(1000, "m", "The text's formula"), (1, "mm", "Right K, but the division dropped")]
for axis, value, (unit, name, title) in zip(axes, errors.values(), panels, strict=True):
    shown = axis.imshow(value / unit, extent=(0.5, 640.5, 480.5, 0.5), cmap="viridis", vmin=0)
    lines = axis.contour(grid[..., 0], grid[..., 1], value / unit, levels=5, colors="white", linewidths=0.7)
    axis.clabel(lines, fmt=f"%g {name}", fontsize=8)
    axis.plot(320, 240, "+", color="white", markersize=10)
    figure.colorbar(shown, ax=axis, shrink=0.86, label=f"error on the table [{name}]")
    axis.set(title=title, xlabel="x [px]", ylabel="y [px]")
plt.show()

# %% [markdown]
# The left panel is metres, the right one millimetres: the transposed matrix is the mistake that ruins the
# formula, the lost division is the one that would still have to be mended for picking.

# %% [markdown]
# ## Doubts about the inputs
#
# MATLAB exports the rotation transposed as well. The text does not say whether it undid that, and uses the
# columns of R as printed; so does everything above. And R is a rotation only to 3 in 1000, more than
# rounding to four decimals explains: its entries 0.0136 and −0.0162 should be nearly opposite, so one is
# misprinted. How much do they matter, beside another count of pixels?

# %%
print(f"largest entry of R Rᵀ − 1: {np.abs(R @ R.T - np.eye(3)).max():.4f}")
U, _, Vt = np.linalg.svd(R)
opposite = R.copy()
opposite[2, 1] = -0.0136
doubts = {
    "R transposed": rightly(grid, SE3(R.T, t / 1000)),
    "−0.0162 read as −0.0136": rightly(grid, SE3(opposite, t / 1000)),
    "the rotation nearest to R": 1000 * plane_from_pixels(camera, SE3(U @ Vt, t / 1000), grid - 1),
    "pixels counted from 0": rightly(grid + 1),
}
for name, other in doubts.items():
    shift = np.linalg.norm(other - truth, axis=-1)
    print(
        f"{name:26s} moves (320, 240) by {shift[239, 319]:.2f} mm, any pixel by at most {shift.max():.2f} mm"
    )

# %% [markdown]
# Millimetres, and centimetres at the corners, matter to a gripper, not to the finding. They are why this
# library writes `cam_from_station` with one meaning, converts others' matrices and pixels when a file is
# read, and checks each round trip: see CONVENTIONS.md.
