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
# # Three trackers on one video
#
# The text follows a pencil by three methods: optical flow, a box in the cube of RGB colours, and
# subtraction of the background. Each hangs on a threshold that somebody sets by a slider. Here all three
# run on one rendered video whose truth is known exactly: first as the text has them, over the whole
# travel of each slider; then in this library's forms, which choose for themselves. At the end, a real
# street.

# %%
import tempfile
from itertools import islice
from pathlib import Path

import cv2
import matplotlib.pyplot as plt
import mvtbdata
import numpy as np

from vision_robot.dataset import open_dataset
from vision_robot.evaluate.tracking.figures import tracking_figures
from vision_robot.flow import horn_schunck_sweeps
from vision_robot.track import tracker_named
from vision_robot.track.session import Session
from vision_robot.tracks import Tracks
from vision_robot.video import Frame, Video
from vision_robot_synth.making import synthesise
from vision_robot_synth.recipe import read_recipe

plt.style.use("look.mplstyle")
folder = Path(tempfile.mkdtemp())

# %% [markdown]
# ## The video and its truth
#
# One and a half seconds of a red rod that wanders over a wooden table and turns, at 30 frames a second,
# with shadow, blur and noise. `vr synth single-rod` makes the same on the command line.


# %%
def made(recipe, frames, size, severity, seed):
    """A dataset of a recipe, and its frames."""
    place = folder / f"{recipe}-{severity}"
    synthesise(read_recipe(recipe).with_video(frames=frames, size=size), place, severity=severity, seed=seed)
    data = open_dataset(place)
    return data, list(data.frames())


data, video = made("single-rod", 45, (320, 240), 0.3, 1)
frames = [frame.image for frame in video]
truth = data.truth
shown = (0, 15, 30, 44)
figure, axes = plt.subplots(1, 4, figsize=(9, 1.8))
for axis, k in zip(axes, shown, strict=True):
    axis.imshow(cv2.GaussianBlur(frames[k], (0, 0), 1.2)[..., ::-1])
    path = truth.centroid_px[truth.frame <= k]
    axis.plot(*path.T, color="white", linewidth=1)
    axis.plot(*path[-1], "+", color="white", markersize=9)
    axis.set_title(f"frame {k}")
    axis.axis("off")
plt.show()

# %% [markdown]
# ## What each method looks at
#
# In one frame: the length of the flow since the frame before; the distance of each pixel's colour from
# the colour read off the rod; the difference from the median of the last frames. The three plain forms
# cut these at a threshold.

# %%
k = 40
click = truth.centroid_px[truth.frame == 0][0]  # a user would click on the rod in the first frame
options = {
    "optical-flow-plain": {},
    "rgb-plain": {"pick": tuple(click)},
    "background-plain": {},
}
grey = [cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY).astype(np.float32) for frame in frames]
speed = np.hypot(*horn_schunck_sweeps(grey[k - 1], grey[k], sweeps=10))
u, v = np.round(click).astype(int)
read_off = np.median(frames[0][v - 1 : v + 2, u - 1 : u + 2].reshape(-1, 3), axis=0)
off = np.abs(frames[k].astype(float) - read_off).max(axis=-1)
difference = np.abs(grey[k] - np.median(grey[k - 24 : k + 1], axis=0))
figure, axes = plt.subplots(1, 3, figsize=(9, 2.2))
panels = (
    (speed, "optical flow: speed [px a frame]", "magma", 1.5),
    (off, "rgb: off the colour read off [levels]", "magma_r", 120),
    (difference, "background: difference [levels]", "magma", 80),
)
for axis, (values, title, colours, most) in zip(axes, panels, strict=True):
    picture = axis.imshow(cv2.medianBlur(values.astype(np.float32), 3), cmap=colours, vmin=0, vmax=most)
    axis.set_title(title)
    axis.axis("off")
    figure.colorbar(picture, ax=axis, shrink=0.7)
plt.show()

# %% [markdown]
# ## The sliders, all positions at once
#
# Optical flow has its threshold from the mean velocity, so its slider is the weight α of smoothness; the
# other two have the threshold itself. The small pictures show what counts as object at frame 40 (dark);
# the curves how well the rod is followed over the whole video: success is the overlap of boxes, averaged
# (0 to 1).

# %%
SLIDERS = {
    "optical-flow-plain": ("alpha", (1, 4, 15, 40, 120)),
    "rgb-plain": ("tolerance", (8, 20, 40, 90, 130)),
    "background-plain": ("threshold", (3, 8, 25, 45, 80)),
}


plane = data.plane(0)


def followed(name, given, source=video, plane=plane, truth=truth):
    """Figures of a tracker on the video, its session, masks and tracks."""
    session = Session(tracker_named(name, given), plane=plane)
    masks, rows = [], []
    for step in session.run(source):
        masks.append(session.tracker.mask.copy())
        rows.append(step.final)
    tracks = Tracks.joined([*rows, session.rest()])
    return tracking_figures(truth, tracks), session, masks, tracks


success, masks = {}, {}
for name, (slider, values) in SLIDERS.items():
    for value in values:
        found, _, seen, _ = followed(name, {**options[name], slider: value})
        success[name, value] = np.nan_to_num(found["success_auc"])
        masks[name, value] = seen[k]

figure, axes = plt.subplots(3, 5, figsize=(10, 5))
for row, (name, (slider, values)) in zip(axes, SLIDERS.items(), strict=True):
    for axis, value in zip(row, values, strict=True):
        axis.imshow(masks[name, value] > 0, cmap="gray_r", vmin=0, vmax=1)
        axis.set_title(f"{slider} {value}: {success[name, value]:.2f}", fontsize=8)
        axis.set(xticks=[], yticks=[])
        for spine in axis.spines.values():
            spine.set(visible=True, color="#b4bcc6")
    row[0].set_ylabel(name.removesuffix("-plain"))
plt.show()

# %% [markdown]
# ## The forms that choose for themselves
#
# `optical-flow`, `rgb` and `background` find noise, thresholds and least area in the video. No slider is
# set; `rgb` has been told the same click.

# %%
BEST = {"optical-flow": {}, "rgb": {"pick": tuple(click)}, "background": {}}
runs = {name: followed(name, given) for name, given in (*options.items(), *BEST.items())}
columns = ("success_auc", "recall", "mota", "centroid_error_px", "centroid_error_mm", "yaw_error_deg")
print(f"{'':20s}" + "".join(f"{name.replace('_error', ''):>13s}" for name in columns))
for name, (found, _, _, _) in runs.items():
    print(f"{name:20s}" + "".join(f"{found[column]:13.3f}" for column in columns))

figure, axes = plt.subplots(1, 3, figsize=(10, 2.6), sharey=True)
for axis, (name, (slider, values)) in zip(axes, SLIDERS.items(), strict=True):
    axis.semilogx(
        values, [success[name, value] for value in values], "o-", color="C5", label="plain, by slider"
    )
    best = name.removesuffix("-plain")
    axis.axhline(runs[best][0]["success_auc"], color="C0", label=f"{best}: no slider")
    axis.set(xlabel=slider, title=best, ylim=(0, 1), xticks=values, xticklabels=values)
    axis.minorticks_off()
    axis.legend(loc="lower center")
axes[0].set_ylabel("success")
plt.show()
for name, (_, values) in SLIDERS.items():
    best = runs[name.removesuffix("-plain")][0]["success_auc"]
    assert best > np.mean([success[name, value] for value in values])

# %% [markdown]
# The plain forms can be good, at one position of the slider, on one video. What the sliders cost is not
# the best position but not knowing it.
#
# Where the rod was said to be, less where it was:

# %%
figure, axes = plt.subplots(1, 3, figsize=(10, 2.6), sharey=True)
for axis, best in zip(axes, BEST, strict=True):
    for name, colour in ((f"{best}-plain", "C5"), (best, "C0")):
        tracks = runs[name][3]
        main = np.bincount(tracks.id).argmax() if len(tracks) else -1  # the track with most rows
        rows = np.flatnonzero(tracks.id == main)
        there = {int(f): truth.centroid_px[i] for i, f in enumerate(truth.frame)}
        error = [np.linalg.norm(tracks.centroid_px[i] - there[int(tracks.frame[i])]) for i in rows]
        axis.plot(tracks.frame[rows], error, ".", color=colour, label=name)
    axis.set(title=best, xlabel="frame", ylim=(0, 12))
    axis.legend()
axes[0].set_ylabel("error of the centroid [px]")
plt.show()

# %% [markdown]
# ## Where each one ends
#
# The text's own weak point of subtraction: "an object close to the background's colour is missed". And
# its claim that RGB is best. Two harder videos, the same six methods:

# %%
harder = {
    "as above": None,
    "rod nearly wood-coloured": ("near-background", 0.85),
    "light drifts": ("illumination-drift", 0.5),
}
scores = {"as above": {name: run[0]["success_auc"] for name, run in runs.items()}}
for title, given in harder.items():
    if given is None:
        continue
    other, moving = made(given[0], 45, (320, 240), given[1], 1)
    spot = tuple(other.truth.centroid_px[other.truth.frame == 0][0])
    scores[title] = {}
    for name in runs:
        told = {"pick": spot} if name.startswith("rgb") else {}
        found = followed(name, told, moving, other.plane(0), other.truth)[0]
        scores[title][name] = float(np.nan_to_num(found["success_auc"]))
figure, axes = plt.subplots(1, 3, figsize=(10, 2.7), sharey=True)
for axis, (title, row) in zip(axes, scores.items(), strict=True):
    for place, best in enumerate(BEST):
        axis.bar(place - 0.2, row[f"{best}-plain"], 0.38, color="C5", label="plain" if place == 0 else None)
        axis.bar(place + 0.2, row[best], 0.38, color="C0", label="best form" if place == 0 else None)
    axis.set(title=title, xticks=range(3), xticklabels=list(BEST), ylim=(0, 1))
axes[0].set_ylabel("success")
axes[0].legend(loc="upper center", ncols=2, bbox_to_anchor=(0.5, -0.12))
plt.show()
for row in scores.values():
    print({name: round(value, 2) for name, value in row.items()})

# %% [markdown]
# Of the plain forms the box in the cube of colours answers quickest and shares the first place, as the
# text says, while light and colours are kind; it is gone when the rod's colour nears the table's. Which
# of them "is best" is a question about the video, not about the method. The odds that `rgb` learns and the
# medians of `background` hold in all three. Drifting light breaks the one assumption of optical flow, that
# brightness is kept: the plain form is lost there, the best one evens the light out beforehand.

# %%
nearly, drifting = scores["rod nearly wood-coloured"], scores["light drifts"]
assert scores["as above"]["rgb-plain"] > 0.9
assert nearly["rgb-plain"] < min(nearly["optical-flow-plain"], nearly["background-plain"])
assert all(row["rgb"] > 0.8 and row["background"] > 0.8 for row in scores.values())
assert drifting["optical-flow-plain"] < min(0.6, drifting["optical-flow"])

# %% [markdown]
# ## A real street
#
# `traffic_sequence.mp4` of the package `mvtb-data`, two and a half seconds of the crossing. Nobody labelled
# it, so there is no score, only what one sees, and what the trackers say of themselves.

# %%
photographed = Video(Path(mvtbdata.__file__).parent / "images" / "traffic_sequence.mp4")
street = [
    Frame(frame.index, frame.time_s, frame.image[140:460, 100:500]) for frame in islice(photographed, 75)
]
at = 55
figure, axes = plt.subplots(1, 2, figsize=(9, 3.7))
for axis, name in zip(axes, ("background", "optical-flow"), strict=True):
    session = Session(tracker_named(name))
    steps = list(session.run(street))
    tracks = Tracks.joined([*(step.final for step in steps), session.rest()])
    axis.imshow(cv2.GaussianBlur(steps[at].frame.image, (0, 0), 1)[..., ::-1])
    for one in np.unique(tracks.id):
        rows = tracks.id == one
        if rows.sum() < 15:
            continue
        line = axis.plot(*tracks.centroid_px[rows].T, linewidth=1.2)[0]
        for i in np.flatnonzero(rows & (tracks.frame == at)):
            left, top, width, height = tracks.box_px[i]
            axis.add_patch(plt.Rectangle((left, top), width, height, fill=False, edgecolor=line.get_color()))
    axis.set_title(f"{name}: {session.objects} objects")
    axis.axis("off")
    print(name, *(f"  {tone}: {sentence}" for tone, sentence in session.remarks()), sep="\n")
    assert session.objects >= 3
plt.show()

# %% [markdown]
# Subtraction parts the cars and follows the lanes. Optical flow joins cars that drive together into one
# thing that moves alike, which is what it was asked for. In queues like the one at the top neither keeps
# every car's name: dense traffic is not what these three methods are for.
