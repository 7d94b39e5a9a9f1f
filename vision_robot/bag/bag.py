"""One topic of a bag as a video."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from vision_robot.errors import BadBag, BadFrame, MissingPackage
from vision_robot.types import Image
from vision_robot.video import LIKELY_FPS, Frame

from .picture_message import IMAGE_TYPES, PictureMessages

__all__ = ["BAG_SUFFIXES", "Bag", "is_bag"]

BAG_SUFFIXES = (".bag", ".db3", ".mcap")

USUAL_FPS = 25.0


def is_bag(path: Path | str) -> bool:
    """Whether the path names a bag: a file by its suffix, a folder by its metadata.yaml."""
    place = Path(path)
    return place.suffix.lower() in BAG_SUFFIXES or (place.is_dir() and (place / "metadata.yaml").is_file())


class Bag:
    """The pictures of one topic, streamed as by `Video`; iterate over it as often as wanted.

    `topic` may be left out where only one holds pictures. Times are those of the messages' headers, from the
    first picture on; where the first has none, those of recording. Raises BadBag for what is
    no bag or does not say which topic, MissingPackage without rosbags.
    """

    def __init__(self, path: Path | str, topic: str | None = None):
        self.path = Path(path)
        if not self.path.exists():
            raise BadBag(path, "there is no such file")
        with self._opened() as reader:
            self.topics = _picture_topics(reader)
            self.topic = self._chosen(topic)
            self.frame_count = self.topics[self.topic]
            seconds = (reader.end_time - reader.start_time) / 1e9
        fps = (self.frame_count - 1) / seconds if seconds > 0 else USUAL_FPS
        self.fps = fps if LIKELY_FPS[0] <= fps <= LIKELY_FPS[1] else USUAL_FPS
        first = next(iter(self), None)
        if first is None:
            raise BadBag(path, f"topic {self.topic} holds no picture")
        self.size = (int(first.image.shape[1]), int(first.image.shape[0]))

    def __iter__(self) -> Iterator[Frame]:
        start_ns = last = None
        for index, (time_ns, decode) in enumerate(self.pictures()):
            image = decode()
            if start_ns is None:
                start_ns = time_ns
            time_s = (time_ns - start_ns) / 1e9
            if last is not None and not time_s > last:
                time_s = last + 1e-3 / self.fps
            yield Frame(index, time_s, image)
            last = time_s

    def pictures(self) -> Iterator[tuple[int, Callable[[], Image]]]:
        """Time [ns] and a way to the picture, for each message; decoding is left to who wants it."""
        messages = PictureMessages()
        with self._opened() as reader:
            connections = [one for one in reader.connections if one.topic == self.topic]
            decoded = _decoder_of(self.path)
            from_headers: bool | None = None
            for index, (connection, recorded_ns, data) in enumerate(reader.messages(connections)):
                message = decoded(data, connection.msgtype)
                stamp = message.header.stamp
                stamp_ns = int(stamp.sec) * 10**9 + int(stamp.nanosec)
                if from_headers is None:
                    from_headers = stamp_ns > 0
                yield stamp_ns if from_headers else recorded_ns, self._picture(messages, message, index)

    def _picture(self, messages: PictureMessages, message: Any, index: int) -> Callable[[], Image]:
        def decode() -> Image:
            try:
                return messages.picture(message, index)
            except BadFrame as error:
                raise BadBag(self.path, f"picture {index} of {self.topic}: {error.why}") from error

        return decode

    def _chosen(self, topic: str | None) -> str:
        known = ", ".join(f"{name} ({count})" for name, count in self.topics.items())
        if not self.topics:
            raise BadBag(self.path, f"no topic in it holds pictures ({' or '.join(IMAGE_TYPES)})")
        if topic is None and len(self.topics) > 1:
            raise BadBag(self.path, f"several topics hold pictures: choose with --topic among {known}")
        if topic is not None and topic not in self.topics:
            raise BadBag(self.path, f"it has no pictures on topic {topic}, but on {known}")
        return topic or next(iter(self.topics))

    @contextmanager
    def _opened(self) -> Iterator[Any]:
        try:
            from rosbags.rosbag1 import Reader as Reader1
            from rosbags.rosbag2 import Reader as Reader2
        except ImportError as error:
            raise MissingPackage("rosbags", "reading ROS bags") from error
        try:
            with (Reader1 if _is_ros1(self.path) else Reader2)(self.path) as reader:
                yield reader
        except (BadBag, GeneratorExit):
            raise
        except Exception as error:  # a damaged file can fail anywhere in the reader, in any way
            raise BadBag(self.path, f"{' '.join(str(error).split()) or type(error).__name__}") from error


def _is_ros1(path: Path) -> bool:
    return path.suffix.lower() == ".bag"


def _picture_topics(reader: Any) -> dict[str, int]:
    topics: dict[str, int] = {}
    for one in reader.connections:
        if one.msgtype in IMAGE_TYPES:
            topics[one.topic] = topics.get(one.topic, 0) + one.msgcount
    return dict(sorted(topics.items()))


def _decoder_of(path: Path) -> Callable[[bytes, str], Any]:
    """Reads a message by the definitions that come with rosbags, never by those in the file."""
    from rosbags.typesys import Stores, get_typestore

    if _is_ros1(path):
        return get_typestore(Stores.ROS1_NOETIC).deserialize_ros1
    return get_typestore(Stores.ROS2_HUMBLE).deserialize_cdr
