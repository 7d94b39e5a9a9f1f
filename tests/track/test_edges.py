"""Edges placed by the frame: errors of hundredths of a pixel where masks make tenths."""

import numpy as np
import pytest

from tests.track.drawn import Shape, frame_of, table
from vision_robot.track.blob_analysis import analyse
from vision_robot.track.edges import LARGE, analyse_edges

SIZE = (160, 120)


def seen(shape: Shape, noise: float, seed: int, size=SIZE):
    """Frame, background and the mask a threshold gives."""
    clean = table(size)
    frame, background = frame_of(clean, [shape], noise=noise, seed=seed), np.rint(clean).astype(np.uint8)
    apart = np.abs(frame.astype(int) - background).max(axis=2)
    return frame, background, (apart > 15).astype(np.uint8)


@pytest.mark.parametrize(
    ("length", "width", "colour", "noise", "limit"),
    [
        (20, 20, (40, 40, 200), 0, 0.003),
        (80, 6, (30, 60, 90), 0, 0.005),
        (60, 4, (30, 30, 30), 0, 0.02),
        (20, 20, (40, 40, 200), 3, 0.02),
        (80, 6, (30, 60, 90), 3, 0.05),
    ],
)
@pytest.mark.parametrize("known_background", [True, False])
def test_centroid_area_and_yaw(length, width, colour, noise, limit, known_background):
    rng = np.random.default_rng(4)
    ours, masks = [], []
    for seed in range(12):
        u, v = np.array([80, 60]) + rng.uniform(-0.5, 0.5, 2)
        shape = Shape(u, v, length, width, rng.uniform(-1.5, 1.5), colour)
        frame, background, mask = seen(shape, noise, seed)
        blobs, _ = analyse_edges(mask, frame, background if known_background else None)
        blobs = blobs.rows(blobs.area_px >= 20)
        whole = analyse(mask, min_area_px=20)
        assert len(blobs) == 1
        ours.append(blobs.centroid_px[0] - (u, v))
        masks.append(whole.centroid_px[0] - (u, v))
        assert blobs.area_px[0] == pytest.approx(shape.area, rel=0.03)
        if length > width:
            assert abs(np.sin(blobs.yaw_rad[0] - shape.yaw)) < np.radians(0.05 + 0.02 * noise)
    error = np.sqrt(np.mean(np.square(ours)))
    assert error < limit * (1 if known_background else 6)
    if not noise:
        assert error < np.sqrt(np.mean(np.square(masks))) / 4


def test_where_the_threshold_falls_hardly_matters():
    """A mask grown or shrunk by a pixel gives the same disc."""
    import cv2

    shape = Shape(80.3, 59.8, 24, 24)
    frame, background, mask = seen(shape, 0, 0)
    square = np.ones((3, 3), np.uint8)
    for other in (cv2.erode(mask, square), cv2.dilate(mask, square)):
        blobs, runs = analyse_edges(np.asarray(other, np.uint8), frame, background)
        sharp = runs.painted(np.ones(1), mask.shape)
        assert blobs.centroid_px[0] == pytest.approx([80.3, 59.8], abs=0.01)
        assert blobs.area_px[0] == pytest.approx(shape.area, rel=0.005)
        assert sharp.sum() == pytest.approx(shape.area, rel=0.03)


def test_a_disc_has_its_diameter_as_axes_and_its_box_around_it():
    frame, background, mask = seen(Shape(80, 60, 30, 30), 0, 0)
    blobs, _ = analyse_edges(mask, frame, background)
    assert blobs.axes_px[0] == pytest.approx([30, 30], rel=0.01)
    left, top, width, height = blobs.box_px[0]
    assert (left + width / 2, top + height / 2) == pytest.approx((80, 60), abs=0.51)
    assert (width, height) == pytest.approx((30, 30), abs=1.01)


def test_parts_of_a_large_picture_give_what_the_whole_gives():
    size = (700, 500)
    assert size[0] * size[1] > LARGE
    clean = table(size)
    shapes = [Shape(6.2, 5.4, 14, 14), Shape(350.3, 250.1, 40, 8, 0.5), Shape(694.1, 493.3, 16, 16)]
    frame, background = frame_of(clean, shapes), np.rint(clean).astype(np.uint8)
    mask = (np.abs(frame.astype(int) - background).max(axis=2) > 15).astype(np.uint8)
    blobs, runs = analyse_edges(mask, frame, background)
    assert len(blobs) == runs.count == 3
    assert blobs.centroid_px[1] == pytest.approx([350.3, 250.1], abs=0.01)
    for i, (rows, columns) in enumerate(
        [(np.s_[:60], np.s_[:60]), (np.s_[:], np.s_[:]), (np.s_[440:], np.s_[640:])]
    ):
        alone, _ = analyse_edges(mask[rows, columns], frame[rows, columns], background[rows, columns])
        shift = (columns.start or 0, rows.start or 0)
        assert np.abs(alone.centroid_px + shift - blobs.centroid_px[i]).sum(axis=1).min() < 1e-9
    painted = runs.painted(np.array([1, 2, 3]), mask.shape)
    inside = np.rint(blobs.centroid_px).astype(int)
    assert painted[inside[:, 1], inside[:, 0]].tolist() == [1, 2, 3]


def test_what_is_like_its_background_stays_as_the_mask_has_it():
    frame = np.full((40, 50, 3), 90, np.uint8)
    mask = np.zeros((40, 50), np.uint8)
    mask[10:20, 15:35] = 1
    blobs, runs = analyse_edges(mask, frame, frame)
    assert blobs.area_px.tolist() == [200]
    assert np.array_equal(runs.painted(np.ones(1), mask.shape) > 0, mask > 0)
    nothing, _ = analyse_edges(np.zeros_like(mask), frame)
    assert not len(nothing)
