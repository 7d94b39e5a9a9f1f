"""Blob analysis: scikit-image's numbers to 1e-6, exact shapes, and MATLAB's convention."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.errors import BadParameter
from vision_robot.track.blob_analysis import analyse


def scattered(seed: int, size: tuple[int, int] = (160, 120), count: int = 12) -> np.ndarray:
    """Ellipses, rods and single pixels, touching the border and each other."""
    rng = np.random.default_rng(seed)
    mask = np.zeros(size[::-1], np.uint8)
    for _ in range(count):
        centre = tuple(int(x) for x in rng.uniform(0, size))
        axes = (int(rng.uniform(0, 25)), int(rng.uniform(0, 9)))
        cv2.ellipse(mask, centre, axes, float(rng.uniform(0, 180)), 0, 360, 255, -1)
    mask[rng.uniform(size=mask.shape) < 0.002] = 255
    return mask


def close(ours, theirs, rtol: float = 1e-6, atol: float = 1e-6) -> bool:
    return np.allclose(ours, theirs, rtol=rtol, atol=atol)


def peer(labels: np.ndarray) -> dict[str, np.ndarray]:
    from skimage.measure import regionprops_table

    names = ("area", "centroid", "bbox", "axis_major_length", "axis_minor_length", "orientation")
    return regionprops_table(labels, properties=(*names, "eccentricity", "extent", "solidity"))


@given(seed=st.integers(0, 10_000))
def test_it_agrees_with_scikit_image(seed):
    from skimage.measure import label

    mask = scattered(seed)
    ours = analyse(mask, solidity=True)
    labels = np.asarray(label(mask > 0))
    theirs = peer(labels)
    # Both number blobs by their first pixel, but cv2 looks at blocks of 2x2: match by position.
    mine = np.lexsort(np.round(ours.centroid_px, 6).T)
    other = np.lexsort(np.round(np.stack([theirs["centroid-1"], theirs["centroid-0"]]), 6))
    ours = ours.rows(mine)
    theirs = {name: column[other] for name, column in theirs.items()}
    assert close(ours.area_px, theirs["area"])
    assert close(ours.centroid_px[:, 0], theirs["centroid-1"])
    assert close(ours.centroid_px[:, 1], theirs["centroid-0"])
    assert np.array_equal(ours.box_px[:, 0] + 0.5, theirs["bbox-1"])
    assert np.array_equal(ours.box_px[:, 1] + 0.5, theirs["bbox-0"])
    assert np.array_equal(ours.box_px[:, 2], theirs["bbox-3"] - theirs["bbox-1"])
    assert np.array_equal(ours.box_px[:, 3], theirs["bbox-2"] - theirs["bbox-0"])
    assert close(ours.axes_px[:, 0], theirs["axis_major_length"])
    # scikit-image takes the small eigenvalue of a line as rounding leaves it; a root of it is 1e-7 at most.
    assert close(ours.axes_px[:, 1], theirs["axis_minor_length"])
    assert close(ours.extent, theirs["extent"])
    assert close(ours.extra["solidity"], theirs["solidity"])
    known = np.isfinite(ours.yaw_rad)
    assert close(ours.eccentricity[known], theirs["eccentricity"][known])
    # Their angle runs from v towards u; an axis has no sense of direction.
    turned = ours.yaw_rad[known] - (np.pi / 2 - theirs["orientation"][known])
    assert close(np.sin(turned), 0)
    # Where one direction is no longer than another, there is no angle to agree on.
    assert close(ours.axes_px[~known, 0], ours.axes_px[~known, 1], atol=1e-4)


def test_labels_tell_touching_blobs_apart():
    from skimage.measure import regionprops_table

    labels = np.zeros((20, 30), int)
    labels[3:9, 4:12], labels[3:9, 12:20], labels[9:15, 4:12] = 1, 4, 7
    ours = analyse(labels)
    theirs = regionprops_table(labels, properties=("area", "centroid"))
    assert close(ours.area_px, theirs["area"])
    assert close(ours.centroid_px[:, 0], theirs["centroid-1"])


def test_grey_levels_weigh():
    from skimage.measure import regionprops_table

    rng = np.random.default_rng(5)
    labels = np.zeros((40, 50), int)
    labels[5:20, 6:30], labels[25:35, 10:45] = 1, 2
    grey = rng.integers(1, 256, labels.shape).astype(np.uint8)
    ours = analyse(labels, grey)
    theirs = regionprops_table(labels, grey, properties=("centroid_weighted",))
    assert close(ours.centroid_px[:, 0], theirs["centroid_weighted-1"])
    assert close(ours.centroid_px[:, 1], theirs["centroid_weighted-0"])
    assert ours.area_px[0] == grey[5:20, 6:30].sum()
    same = analyse(labels, np.full(labels.shape, 0.5))
    assert close(same.axes_px, analyse(labels).axes_px)


@pytest.mark.parametrize(("width", "height"), [(9, 4), (30, 1), (1, 1), (5, 5)])
def test_matlab_axes_of_rectangles_are_exact(width, height):
    """A w x h rectangle of square pixels has second moments w²/12 and h²/12."""
    mask = np.zeros((40, 60), bool)
    mask[7 : 7 + height, 11 : 11 + width] = True
    blob = analyse(mask, axes="matlab")
    expected = 4 * np.sqrt(np.array([max(width, height), min(width, height)]) ** 2 / 12)
    assert close(blob.axes_px[0], expected)
    assert np.isnan(blob.yaw_rad[0]) == (width == height)
    assert blob.centroid_px.tolist() == [[11 + (width - 1) / 2, 7 + (height - 1) / 2]]


@pytest.mark.parametrize("angle", np.radians([-90, -60, -30, 0, 20, 45, 89]))
def test_yaw_runs_from_u_towards_v(angle):
    v, u = np.mgrid[:101, :101] - 50.0
    along, across = u * np.cos(angle) + v * np.sin(angle), v * np.cos(angle) - u * np.sin(angle)
    blob = analyse((np.abs(along) < 40.3) & (np.abs(across) < 4.3))
    assert abs(np.sin(blob.yaw_rad[0] - angle)) < 4e-3  # of a mask of whole pixels
    assert -np.pi / 2 <= blob.yaw_rad[0] < np.pi / 2


def test_no_digits_cancel_in_a_large_picture():
    """Moments of a far-off blob are those of the same blob near the origin."""
    mask = np.zeros((2000, 4000), np.uint8)
    mask[3:9, 4:40] = 1
    near = analyse(mask)
    far = analyse(np.roll(mask, (1980, 3950), (0, 1)))
    assert close(near.axes_px, far.axes_px, 1e-13, 0)


def test_small_blobs_are_left_out_and_kinds_written():
    mask = scattered(3)
    all_of_them, large = analyse(mask), analyse(mask, min_area_px=20, kind=2)
    assert len(large) == (all_of_them.area_px >= 20).sum() < len(all_of_them)
    assert set(large.kind) == {2}
    assert not len(analyse(np.zeros((5, 5), np.uint8), solidity=True))
    full = analyse(np.ones((5, 7), np.uint8))
    assert full.box_px.tolist() == [[-0.5, -0.5, 7, 5]]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"mask": np.zeros((3, 3, 3))}, "shape of the mask"),
        ({"mask": np.zeros((3, 3), np.uint8), "weight": np.zeros((3, 4))}, "shape of the weight"),
        ({"mask": np.ones((3, 3), np.uint8), "weight": np.zeros((3, 3))}, "positive sum"),
        ({"mask": np.ones((3, 3), np.uint8), "axes": "opencv"}, "skimage, matlab"),
    ],
)
def test_bad_input_is_named(arguments, says):
    with pytest.raises(BadParameter, match=says):
        analyse(**arguments)
