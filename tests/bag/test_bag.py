"""Proves that a topic of a bag is a video: pictures, times, the choice of the topic, and what damage says."""

from contextlib import suppress

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.bag.bags import KINDS, packed, raw, write_bag
from vision_robot.bag import Bag, is_bag
from vision_robot.errors import BadBag, BadParameter, MissingPackage
from vision_robot.images import open_images
from vision_robot.track.sources import open_recording
from vision_robot.video import Video

RNG = np.random.default_rng(1)
PICTURES = [RNG.integers(0, 256, (24, 32, 3), dtype=np.uint8) for _ in range(5)]


@pytest.fixture(params=KINDS)
def bag(request, tmp_path):
    """A bag with one topic of raw colour pictures."""
    return write_bag(tmp_path, request.param, {"/camera/image_raw": [raw(one, "bgr8") for one in PICTURES]})


def test_every_kind_gives_the_pictures_and_their_own_times(bag):
    assert is_bag(bag)
    found = Bag(bag)
    assert (found.topic, found.size, found.frame_count) == ("/camera/image_raw", (32, 24), 5)
    assert found.fps == pytest.approx(25, rel=0.01)
    for _ in range(2):  # from its start, as often as wanted
        frames = list(found)
        assert [frame.index for frame in frames] == [0, 1, 2, 3, 4]
        np.testing.assert_allclose([frame.time_s for frame in frames], 0.04 * np.arange(5), atol=1e-9)
        for frame, picture in zip(frames, PICTURES, strict=True):
            np.testing.assert_array_equal(frame.image, picture)


def test_single_files_of_ros_2_are_bags_too(tmp_path):
    for kind, suffix in (("mcap", ".mcap"), ("sqlite3", ".db3")):
        folder = write_bag(tmp_path, kind, {"/a": [raw(one, "bgr8") for one in PICTURES]})
        (file,) = folder.glob(f"*{suffix}")
        np.testing.assert_array_equal(next(iter(Bag(file))).image, PICTURES[0])


def test_compressed_pictures(tmp_path):
    path = write_bag(tmp_path, "ros1", {"/camera/compressed": [packed(one) for one in PICTURES]})
    for frame, picture in zip(Bag(path), PICTURES, strict=True):
        np.testing.assert_array_equal(frame.image, picture)


def test_of_several_topics_one_is_chosen(tmp_path):
    topics = {"/left": [raw(PICTURES[0], "bgr8")], "/right": [packed(one) for one in PICTURES[1:]]}
    path = write_bag(tmp_path, "mcap", topics)
    with pytest.raises(BadBag, match=r"choose with --topic among /left \(1\), /right \(4\)"):
        Bag(path)
    with pytest.raises(BadBag, match="no pictures on topic /top, but on /left"):
        Bag(path, "/top")
    np.testing.assert_array_equal(next(iter(Bag(path, "/right"))).image, PICTURES[1])


def test_a_bag_is_what_pictures_and_trackers_open(bag, tmp_path):
    pictures = open_images([bag])
    assert list(pictures) == [f"{bag.name}#{index:06d}" for index in range(5)]
    for picture, same in zip(pictures.values(), PICTURES, strict=True):
        np.testing.assert_array_equal(picture, same)
    assert len(open_images([bag], every=2, topic="/camera/image_raw")) == 3
    assert isinstance(open_recording(bag), Bag)
    with pytest.raises(BadParameter, match="no ROS bag is given"):
        open_images([write_picture(tmp_path / "photo.png")], topic="/camera")


def write_picture(path):
    path.write_bytes(packed(PICTURES[0])["data"].tobytes())
    return path


def test_a_topic_of_a_video_is_refused(tmp_path):
    with pytest.raises(BadParameter, match="is no ROS bag"):
        open_recording(tmp_path / "film.mp4", "/camera")
    assert not is_bag(tmp_path)
    assert not isinstance(Bag, Video)


def test_headers_without_time_leave_the_time_of_recording(tmp_path, monkeypatch):
    monkeypatch.setattr("tests.bag.bags._header", _timeless)
    path = write_bag(tmp_path, "ros1", {"/a": [raw(one, "bgr8") for one in PICTURES]})
    np.testing.assert_allclose([frame.time_s for frame in Bag(path)], 0.04 * np.arange(5), atol=1e-9)


def _timeless(store, kind, index, time_ns):
    stamp = store.types["builtin_interfaces/msg/Time"](sec=0, nanosec=0)
    return store.types["std_msgs/msg/Header"](seq=index, stamp=stamp, frame_id="")


def test_damage_is_one_error(bag, tmp_path):
    file = bag if bag.is_file() else next(one for one in bag.iterdir() if one.suffix != ".yaml")
    data = file.read_bytes()
    for kept in (data[: len(data) // 3], b"", b"\0" * 100):
        file.write_bytes(kept)
        with pytest.raises(BadBag, match="cannot be used as a ROS bag"):
            list(Bag(bag))
    with pytest.raises(BadBag, match="no such file"):
        Bag(tmp_path / "none.bag")


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """The bytes of a bag with pictures of both kinds."""
    topics = {"/a": [raw(PICTURES[0], "bgr8")] * 2, "/b": [packed(PICTURES[1])] * 2}
    return write_bag(tmp_path_factory.mktemp("sound"), "ros1", topics).read_bytes()


@given(st.data())
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_damage_anywhere_is_refused_or_read(sound, tmp_path, data):
    """Never another error, whatever bytes are changed or missing."""
    places = st.integers(0, len(sound) - 1)
    damaged = bytearray(sound)
    for place, value in data.draw(st.lists(st.tuples(places, st.integers(0, 255)), min_size=1, max_size=12)):
        damaged[place] = value
    path = tmp_path / "damaged.bag"
    path.write_bytes(damaged[: data.draw(st.sampled_from([len(sound), data.draw(places)]))])
    for topic in ("/a", "/b"):
        with suppress(BadBag):
            assert all(frame.image.dtype == np.uint8 for frame in Bag(path, topic))


def test_bags_without_pictures_and_empty_topics(tmp_path):
    path = write_bag(tmp_path, "ros1", {"/a": []})
    with pytest.raises(BadBag, match="picture"):
        Bag(path)


def test_without_rosbags_it_says_what_to_install(bag, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "rosbags.rosbag1", None)
    with pytest.raises(MissingPackage, match="reading ROS bags needs the package rosbags"):
        Bag(bag)
