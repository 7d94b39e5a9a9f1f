"""Proves that what moves is found and measured, that what stops is kept, and that noise is no motion."""

import numpy as np
import pytest

from tests.track.drawn import Shape, frame_of, table
from vision_robot.errors import BadParameter
from vision_robot.track import tracker_named
from vision_robot.track.optical_flow import OpticalFlow, OpticalFlowOptions
from vision_robot.track.parting import parted

SIZE = (240, 180)
TABLE = table(SIZE, 1)
FPS = 25


def rods(k):
    """A rod that goes 2 px a frame and stops after 50 frames, and a disc that goes on."""
    return [Shape(50 + 2 * min(k, 50), 60, 50, 10, 0.5), Shape(200 - 2 * k, 130, 24, 24, 0, (60, 180, 60))]


def frames(count, shapes=rods, noise=2.0):
    return [frame_of(TABLE, shapes(k), noise=noise, seed=k) for k in range(count)]


def followed(tracker, video, *, look=True):
    times = [k / FPS for k in range(len(video))]
    if look:
        tracker.learn(zip(video, times, strict=True))
    return [tracker.step(frame, time) for frame, time in zip(video, times, strict=True)]


def nearest(blobs, shape):
    gaps = np.linalg.norm(blobs.centroid_px - [shape.u, shape.v], axis=1)
    return int(gaps.argmin()), float(gaps.min())


def test_moving_things_are_found_between_pixels_and_kept_when_they_stop():
    tracker = OpticalFlow()
    seen = followed(tracker, frames(75))
    errors = []
    for k in range(3, 75):
        assert len(seen[k]) == 2, f"frame {k}"
        for shape in rods(k):
            row, gap = nearest(seen[k], shape)
            errors.append(gap)
            assert seen[k].area_px[row] == pytest.approx(shape.area, rel=0.05)
    assert np.median(errors) < 0.1
    assert max(errors) < 1
    row, _ = nearest(seen[70], rods(70)[0])
    assert seen[70].yaw_rad[row] == pytest.approx(0.5, abs=0.01)
    assert tracker.mask.shape == SIZE[::-1]
    assert tracker.figures()["threshold_px"] < 1
    assert all(tone in ("good", "note") for tone, _ in tracker.remarks())


def test_what_stands_for_longer_than_it_is_held_is_scene():
    seen = followed(OpticalFlow(OpticalFlowOptions(hold_s=0.4)), frames(130), look=False)
    assert len(seen[55]) == 2
    assert all(nearest(blobs, rods(129)[0])[1] > 20 for blobs in seen[-5:] if len(blobs))


def test_noise_and_still_things_are_no_motion():
    seen = followed(OpticalFlow(), frames(30, lambda _: rods(0), noise=6), look=False)
    assert sum(len(blobs) for blobs in seen) == 0


def test_without_looking_ahead_the_places_left_are_given_back():
    tracker = OpticalFlow()
    seen = followed(tracker, frames(75), look=False)
    assert [len(blobs) for blobs in seen[-15:]] == [2] * 15


def test_light_that_fades_is_no_motion():
    video = [frame_of(TABLE, rods(k), noise=1.5, seed=k, gain=1 - 0.001 * k) for k in range(60)]
    seen = followed(OpticalFlow(), video, look=False)
    assert [len(blobs) for blobs in seen[-10:]] == [2] * 10


def test_a_moving_camera_is_said():
    wide = table((300, 180), 5, 150) + 25 * np.random.default_rng(0).normal(size=(180, 300, 1)).clip(-1, 1)
    tracker = OpticalFlow()
    for k in range(25):
        tracker.step(np.clip(wide[:, 2 * k : 2 * k + 240], 0, 255).astype(np.uint8), k / FPS)
    assert any("camera itself moves" in sentence for _, sentence in tracker.remarks())


def test_slow_things_are_found_against_an_earlier_frame():
    def slow(k):
        return [Shape(60 + 0.06 * k, 90, 60, 14, 0.3)]

    video = frames(60, slow, noise=1.0)
    back = [len(blobs) for blobs in followed(OpticalFlow(OpticalFlowOptions(back=15)), video, look=False)]
    assert sum(back[30:]) > 20


def test_two_that_touch_are_cut_where_they_meet():
    blob = np.zeros((20, 60), np.uint8)
    blob[5:15, 5:55] = 255
    before = np.zeros((20, 60), np.int32)
    before[5:15, 2:27] = 1
    before[5:15, 33:58] = 2
    cut = parted(blob, before, {1: np.array([3.0, 0]), 2: np.array([-3.0, 0])})
    import cv2

    count, _, stats, _ = cv2.connectedComponentsWithStats(cut, connectivity=8)
    assert count == 3
    assert abs(int(stats[1, 4]) - int(stats[2, 4])) <= 20
    np.testing.assert_array_equal(parted(blob, before, {1: np.array([3.0, 0])}), blob)


def test_the_plain_form_finds_what_moves_on_a_quiet_table():
    tracker = tracker_named("optical-flow-plain")
    seen = [tracker.step(frame, k / FPS) for k, frame in enumerate(frames(12, noise=0.0))]
    assert len(seen[0]) == 0
    for shape in rods(11):
        assert nearest(seen[11], shape)[1] < 15
    assert tracker.figures()["threshold_px"] > 0


def test_options_come_from_text_and_are_checked():
    tracker = tracker_named("optical-flow", {"back": "3", "threshold-px": "0.5"})
    assert isinstance(tracker, OpticalFlow)
    assert tracker.options.back == 3
    for tracker, wrong in (("optical-flow", {"back": "0"}), ("optical-flow-plain", {"median-px": "4"})):
        with pytest.raises(BadParameter):
            tracker_named(tracker, wrong)
