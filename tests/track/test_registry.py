"""Trackers by name: options are each their own, plug-ins register by entry point, broken ones are named."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from vision_robot.errors import BadFrame, BadParameter, BrokenPlugin
from vision_robot.track import Blobs, tracker_named, tracker_names
from vision_robot.track.options import options_of

PLUGIN = '''
from dataclasses import dataclass

import numpy as np

from vision_robot.track import Blobs, Tracker


@dataclass(frozen=True)
class Options:
    brighter_than: int = 128


class Brightest(Tracker):
    """The one brightest pixel."""

    name = "brightest"
    Options = Options

    def __init__(self, options=None):
        self.options = options or Options()
        self._mask = None

    def find(self, frame, time_s):
        grey = frame.max(axis=2)
        self._mask = (grey > self.options.brighter_than).astype(np.uint8)
        v, u = np.unravel_index(grey.argmax(), grey.shape)
        if not self._mask.any():
            return Blobs.empty()
        here = np.array([[u, v]], dtype=float)
        box = np.concatenate([here - 0.5, np.ones((1, 2))], axis=1)
        return Blobs(here, box, np.ones(1), np.ones((1, 2)), np.full(1, np.nan))

    @property
    def mask(self):
        return self._mask

    def remarks(self):
        return (("note", "the brightest pixel is taken"),)

    def figures(self):
        return {}
'''


@pytest.fixture
def installed(tmp_path, monkeypatch) -> Path:
    """A package with one good and two broken trackers, as an installer would leave it."""
    (tmp_path / "bright_tracker.py").write_text(PLUGIN)
    info = tmp_path / "bright_tracker-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: bright-tracker\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[vision_robot.trackers]\n"
        "brightest = bright_tracker:Brightest\n"
        "missing = bright_tracker_that_is_not_there:Tracker\n"
        "no-tracker = bright_tracker:Options\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def test_a_plug_in_tracks(installed):
    assert "brightest" in tracker_names()
    tracker = tracker_named("brightest", {"brighter-than": "100"})
    frame = np.zeros((6, 8, 3), np.uint8)
    assert not len(tracker.step(frame, 0.0))
    frame[2, 5] = 101
    assert tracker.step(frame, 0.1).centroid_px.tolist() == [[5, 2]]


@pytest.mark.parametrize(
    ("name", "says"),
    [("missing", "bright_tracker_that_is_not_there"), ("no-tracker", "it is no vision_robot.track.Tracker")],
)
def test_a_broken_plug_in_is_named_with_its_package(installed, name, says):
    assert name in tracker_names()
    with pytest.raises(BrokenPlugin, match=rf"{name} of package bright-tracker .*{says}"):
        tracker_named(name)


def test_an_unknown_tracker_lists_the_known():
    with pytest.raises(BadParameter, match="optical-flow, optical-flow-plain, rgb, rgb-plain, background"):
        tracker_named("kcf")


@dataclass(frozen=True)
class Kinds:
    count: int = 3
    share: float | None = None
    loud: bool = False
    names: tuple[str, ...] = ()
    place: tuple[float, float] | None = None


def test_options_take_the_types_of_their_fields():
    typed = {"count": "7", "share": "0.5", "loud": "yes", "names": "red, blue", "place": "3,4.5"}
    assert options_of(Kinds, typed, "kinds") == Kinds(7, 0.5, True, ("red", "blue"), (3.0, 4.5))
    assert options_of(Kinds, {"share": "auto", "names": ["a"]}, "kinds") == Kinds(names=("a",))
    assert options_of(Kinds, {"share": 1, "place": np.array([1, 2])}, "kinds") == Kinds(share=1, place=(1, 2))


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (
            {"colour": "red"},
            r"option of tracker kinds.*count=3, share=auto, loud=False, names=none",
        ),
        ({"count": "many"}, r"kinds.count is 'many': it must be a whole number"),
        ({"share": "half"}, r"kinds.share is 'half': it must be a number"),
        ({"loud": "very"}, r"kinds.loud is 'very': it must be yes or no"),
        ({"place": "3"}, r"kinds.place is '3': it must be 2 values with commas between"),
    ],
)
def test_a_wrong_option_is_named_with_the_right_ones(given, says):
    with pytest.raises(BadParameter, match=says):
        options_of(Kinds, given, "kinds")


def test_frames_of_any_kind_come_in(installed):
    tracker = tracker_named("brightest")
    frames = [
        np.full((6, 8), 200, np.uint8),
        np.full((6, 8, 1), 200, np.uint8),
        np.full((6, 8, 4), 200, np.uint8),
        np.full((6, 8), 200 * 16, np.uint16),
    ]
    for i, frame in enumerate(frames):
        assert len(tracker.step(frame, float(i))) == 1


@pytest.mark.parametrize(
    ("frame", "time_s", "says"),
    [
        (np.zeros((6, 9, 3), np.uint8), 1, r"frame 1 .* 9x6 px and those before are 8x6 px"),
        (np.zeros((6, 8, 3), np.uint8), 0, r"frame 1 .* rising times"),
        (np.zeros((6, 8, 3), np.float32), 1, "float32"),
        (np.zeros((6, 8, 2), np.uint8), 1, "2 channels"),
        (np.zeros(8, np.uint8), 1, "shape"),
        (np.zeros((0, 8, 3), np.uint8), 1, "shape"),
    ],
)
def test_a_frame_that_does_not_belong_is_refused(installed, frame, time_s, says):
    tracker = tracker_named("brightest")
    tracker.step(np.zeros((6, 8, 3), np.uint8), 0)
    with pytest.raises(BadFrame, match=says):
        tracker.step(frame, time_s)


def test_blobs_join_and_pick():
    one = Blobs(np.ones((2, 2)), np.ones((2, 4)), np.ones(2), np.array([[2, 1.0], [5, 3]]), np.zeros(2))
    both = Blobs.joined([one, Blobs.empty(), one.rows(np.array([True, False]))])
    assert len(both) == 3
    assert both.score.tolist() == [1, 1, 1]
    assert both.eccentricity == pytest.approx([np.sqrt(3) / 2, 0.8, np.sqrt(3) / 2])
