"""Tracker background: exact medians, and what it promises of light, shadows, ghosts and things that stop."""

from dataclasses import replace

import numpy as np
import pytest

from tests.track.drawn import Shape, coverage, frame_of, table
from tests.track.scenes import FPS, GREEN, RED, SIZE, errors, moving, rendered, stepped
from vision_robot.errors import BadParameter
from vision_robot.track import tracker_named
from vision_robot.track.background import Background, BackgroundOptions
from vision_robot.track.background_model import BackgroundModel


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.parametrize("colour", ["rgb", "grey"])
def test_moving_things_are_found_to_hundredths_of_a_pixel(colour):
    tracker = Background(BackgroundOptions(colour=colour))
    distance, missed, extra = errors(stepped(tracker, rendered(moving, 70)), moving)
    assert missed <= 4
    assert extra <= 4
    assert rms(distance) < (0.03 if colour == "rgb" else 0.05)
    # 2 levels of noise, smoothed over nine pixels, and rounded.
    assert 0.4 < tracker.figures()["noise_levels"] < 1.1
    assert any("noise" in text for _, text in tracker.remarks())


def test_the_background_is_numpys_median():
    """With every frame in the window and nothing held back, bit for bit."""
    frames = rendered(moving, 14)
    tracker = Background(BackgroundOptions(window=7, span_s=0, hold_s=0, light=False))
    for k, frame in enumerate(frames):
        tracker.step(frame, k / FPS)
        if k >= 6:
            assert np.array_equal(tracker.background, np.median(frames[k - 6 : k + 1], axis=0))


def test_strips_take_turns_and_each_is_exact():
    frames = rendered(moving, 40)
    model = BackgroundModel(frames[0].shape, window=5, span_s=1.0)
    taken: dict[int, list[np.ndarray]] = {}
    busiest = 0
    for k, frame in enumerate(frames):
        due = model.due(k / FPS)
        busiest = max(busiest, len(due) if k > 20 else 0)
        for strip in due:
            model.take(strip, frame[strip.rows], k / FPS)
            taken.setdefault(strip.rows.start, []).append(frame[strip.rows])
    for strip in model.strips:
        last = taken[strip.rows.start][-5:]
        assert np.array_equal(model.image[strip.rows], np.median(last, axis=0))
    assert busiest < len(model.strips)  # the work is spread


def test_a_thing_that_stops_stays_a_thing_for_as_long_as_asked():
    """It drives in, stops at frame 30; without holding it is background after half the window."""

    def stopping(k: int) -> list[Shape]:
        return [Shape(20 + 4 * min(k, 30), 90, 30, 10, 0.3, RED)]

    frames = rendered(stopping, 150)
    held = stepped(Background(BackgroundOptions(window=9, span_s=1.0, hold_s=60)), frames, ahead=False)
    assert all(len(blobs) == 1 for blobs in held[35:])
    assert np.allclose(held[-1].centroid_px, [[140, 90]], atol=0.1)
    swallowed = stepped(Background(BackgroundOptions(window=9, span_s=1.0, hold_s=0)), frames, ahead=False)
    assert not len(swallowed[-1])
    for_a_second = stepped(Background(BackgroundOptions(window=9, span_s=1.0, hold_s=1)), frames, ahead=False)
    assert len(for_a_second[50])
    assert not len(for_a_second[-1])


@pytest.mark.parametrize("gain", [lambda k: 1 - 0.004 * k, lambda k: 1.0 if k < 40 else 0.7])
def test_light_that_changes_as_a_whole_does_not_matter(gain):
    frames = rendered(moving, 90, gain=gain)
    tracker = Background()
    distance, missed, extra = errors(stepped(tracker, frames), moving)
    assert missed <= 8
    assert extra <= 8
    assert rms(distance) < 0.08
    assert tracker.figures()["scene_changes"] == 0


def test_a_shadow_is_taken_off_its_object():
    """A soft grey shade beside a red disc moves with it; the disc's own centre is what counts."""

    def scene(k: int) -> list[Shape]:
        return [Shape(30 + 2 * k, 90, 24, 24, 0, RED)]

    frames, background = [], table(SIZE)
    for k in range(80):
        (disc,) = scene(k)
        shade = 1 - 0.35 * coverage(replace(disc, u=disc.u + 14, v=disc.v + 6), SIZE)[..., None]
        frames.append(frame_of(background * shade, [disc], noise=2, seed=k))
    distance, missed, _ = errors(stepped(Background(), frames), scene)
    assert missed <= 2
    assert rms(distance) < 0.6
    shaded, _, _ = errors(stepped(Background(BackgroundOptions(shadows=False)), frames), scene, within_px=15)
    assert rms(shaded) > 3


def test_a_ghost_is_laid():
    """A thing there from the start is background; the hole it leaves must not stay an object."""

    def leaving(k: int) -> list[Shape]:
        return [Shape(120 + max(0, 5 * (k - 40)), 90, 30, 12, 0.4, GREEN)]

    tracker = Background(BackgroundOptions(window=9, span_s=2.0, hold_s=60))
    seen = stepped(tracker, rendered(leaving, 110), ahead=False)
    assert tracker.figures()["ghosts"] >= 1
    assert not len(seen[-1])


def test_a_scene_cut_is_learned_anew_and_said():
    frames = rendered(moving, 30)
    other = np.rint(table(SIZE, seed=5, level=90)).astype(np.uint8)[:, ::-1].copy()
    other[:90] = 255 - other[:90]
    tracker = Background(BackgroundOptions(span_s=1.0))
    stepped(tracker, [*frames, *[other] * 10], ahead=False)
    assert tracker.figures()["scene_changes"] == 1
    assert any(tone == "caution" and "changed as a whole" in text for tone, text in tracker.remarks())


def test_the_plain_form_finds_what_moves():
    seen = stepped(tracker_named("background-plain", {"window": "15"}), rendered(moving, 60))
    distance, missed, _ = errors(seen[20:], lambda k: moving(k + 20), within_px=8)
    assert missed <= 8
    assert rms(distance) < 2.5


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"window": "8"}, r"background.window is 8: it must be an odd number"),
        ({"colour": "cmyk"}, "rgb or grey"),
        ({"hold_s": "-1"}, "background.hold_s is -1"),
        ({"tolerance": "3"}, "option of tracker background is 'tolerance': it must be one of window=31"),
    ],
)
def test_bad_options_are_named(options, says):
    with pytest.raises(BadParameter, match=says):
        tracker_named("background", options)
