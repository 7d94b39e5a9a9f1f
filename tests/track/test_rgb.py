"""Tracker rgb: colours by name, point and box, several at once, in changing light, and those not there."""

import numpy as np
import pytest

from tests.track.drawn import Shape, frame_of, table
from tests.track.scenes import SIZE, errors, moving, rendered, stepped
from vision_robot.errors import BadParameter, NoColour
from vision_robot.track import tracker_named
from vision_robot.track.colour_model import ColourModel, cube_colours
from vision_robot.track.colour_names import COLOURS, colour_named
from vision_robot.track.colour_pick import suggestions
from vision_robot.track.rgb import Rgb, RgbOptions


def red_only(k: int) -> list[Shape]:
    return moving(k)[:1]


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.parametrize("asked", [{"color": "red"}, {"pick": "30,45"}, {"roi": "5,38,50,16"}])
def test_one_colour_however_it_is_shown(asked):
    distance, missed, extra = errors(stepped(tracker_named("rgb", asked), rendered(moving, 60)), red_only)
    assert (missed, extra) == (0, 0)
    assert rms(distance) < 0.06


def test_several_colours_are_kinds():
    tracker = Rgb(RgbOptions(color=("green", "red")))
    seen = stepped(tracker, rendered(moving, 40))
    assert all(sorted(blobs.kind.tolist()) == [0, 1] for blobs in seen)
    shown = [blobs.rows(blobs.kind == 1) for blobs in seen]
    _, missed, extra = errors(shown, red_only)
    assert (missed, extra) == (0, 0)
    assert set(np.unique(tracker.mask)) == {0, 1, 2}
    assert tracker.names == ["green", "red"]


@pytest.mark.parametrize(
    "gain", [lambda k: 1 - 0.008 * k, lambda k: 1 if k < 30 else 0.55, lambda k: 1 + 0.004 * k]
)
def test_light_may_change(gain):
    frames = rendered(moving, 60, gain=gain)
    distance, missed, extra = errors(stepped(tracker_named("rgb", {"color": "red"}), frames), red_only)
    assert missed <= 1
    assert extra <= 1
    assert rms(distance) < 0.12
    _, lost, _ = errors(stepped(tracker_named("rgb-plain", {"pick": "30,45"}), frames), red_only)
    assert lost >= missed


def test_paint_that_fades_is_followed():
    """The colour itself drifts, which no gain of the whole picture explains."""

    def fading(k: int) -> list[Shape]:
        return [Shape(40 + 1.5 * k, 90, 40, 12, 0.2, (40 + 0.9 * k, 40 + 0.6 * k, 200 - 0.5 * k))]

    frames = rendered(fading, 100)
    _, missed, _ = errors(stepped(tracker_named("rgb", {"pick": "40,90"}), frames), fading)
    assert missed == 0
    _, lost, _ = errors(stepped(tracker_named("rgb", {"pick": "40,90", "adapt": "0"}), frames), fading)
    assert lost > 10


def test_a_colour_that_is_not_there_is_said_and_found_when_it_comes():
    def late(k: int) -> list[Shape]:
        return moving(k) if k >= 20 else moving(k)[1:]

    tracker = Rgb(RgbOptions(color=("red",)))
    seen = stepped(tracker, rendered(late, 60))
    assert [len(blobs) for blobs in seen[:20]] == [0] * 20
    assert all(len(blobs) == 1 for blobs in seen[24:])
    assert ("caution", "red: this colour is not in the first frame") in tracker.remarks()


def test_clutter_of_a_like_colour_is_left_to_the_background():
    """An orange bar in the scene is inside of many boxes around red, and outside of the odds."""
    background = table(SIZE)
    background[150:170] = (60, 90, 205)
    frames = [frame_of(background, red_only(k), noise=2, seed=k) for k in range(40)]
    _, missed, extra = errors(stepped(tracker_named("rgb", {"pick": "30,45"}), frames), red_only)
    assert (missed, extra) == (0, 0)
    plain = stepped(tracker_named("rgb-plain", {"pick": "30,45", "tolerance": "60"}), frames)
    assert errors(plain, red_only)[2] >= 40


def test_without_a_word_the_colour_that_stands_out_is_taken():
    frames = rendered(red_only, 3)
    assert suggestions(frames[0])[0].colour == "red"
    tracker = Rgb()
    assert len(tracker.step(frames[0], 0.0)) == 1
    assert tracker.names == ["red"]
    with pytest.raises(NoColour, match="vr track pick"):
        Rgb().step(np.full((60, 80, 3), 140, np.uint8), 0.0)


def test_one_look_at_candidates_or_at_all_pixels_gives_the_same():
    rng = np.random.default_rng(3)
    model = ColourModel(2, 12)
    model.learn(
        [rng.integers(0, 90, (500, 3)).astype(np.uint8), rng.integers(150, 255, (500, 3)).astype(np.uint8)],
        rng.integers(80, 170, (500, 3)).astype(np.uint8),
    )
    many = rng.integers(0, 256, (40, 50, 3)).astype(np.uint8)
    few = np.full((200, 200, 3), 120, np.uint8)
    few[:10] = rng.integers(0, 256, (10, 200, 3))
    for gains in (np.ones(3), np.array([0.8, 1.1, 0.9])):
        model.light(gains)
        for frame in (many, few):
            direct = model.kind_of(frame.reshape(-1, 3)).reshape(frame.shape[:2])
            assert np.array_equal(model.classify(frame), direct)


def test_names_hold_their_colours():
    pure = {"red": (0, 0, 255), "green": (0, 255, 0), "blue": (255, 0, 0), "yellow": (0, 255, 255)}
    for name, colour in pure.items():
        held = [other for other in COLOURS if COLOURS[other].holds(np.array(colour))]
        assert held == [name]
    assert colour_named(" Gray ") is COLOURS["grey"]
    named = np.any([colour.holds(cube_colours()) for colour in COLOURS.values()], axis=0)
    assert named.mean() > 0.5


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"color": "mauve"}, "colour is 'mauve': it must be one of red"),
        ({"pick": "3"}, "2 numbers for each thing"),
        ({"roi": "1,2,3"}, "4 numbers for each thing"),
        ({"tolerance": "0"}, "rgb.tolerance"),
        ({"threshold": "3"}, "option of tracker rgb is 'threshold': it must be one of color=none"),
    ],
)
def test_bad_options_are_named(options, says):
    with pytest.raises(BadParameter, match=says):
        tracker_named("rgb", options)


@pytest.mark.parametrize("asked", [{"pick": "900,20"}, {"roi": "200,150,60,60"}])
def test_a_place_outside_the_picture_is_named(asked):
    with pytest.raises(BadParameter, match="inside the picture of 240x180 px"):
        tracker_named("rgb", asked).step(rendered(moving, 1)[0], 0.0)
