"""Pictures from files, folders, patterns, videos and ROS bags, read when they are needed."""

import glob
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import cv2
import numpy as np

from vision_robot.bag import Bag, is_bag
from vision_robot.errors import BadParameter, NoImages, UnreadableImage
from vision_robot.reading import LARGEST_PICTURE, Refusal, read_bytes
from vision_robot.types import Image
from vision_robot.video import open_video

__all__ = ["IMAGE_SUFFIXES", "VIDEO_SUFFIXES", "ImageSource", "decoded", "open_images", "read_image"]

IMAGE_SUFFIXES = (
    ".bmp", ".jp2", ".jpeg", ".jpg", ".pbm", ".pgm", ".png", ".pnm", ".ppm", ".tif", ".tiff", ".webp",
)  # fmt: skip
VIDEO_SUFFIXES = (".avi", ".m4v", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".webm")

DENSEST = 1032
"""Bytes that deflate packs into one, and more than the pixels that a byte of a JPEG can stand for. Files that
claim more are cut off, but decoders make room for the whole before they find out."""

VIDEO_PICTURES = 60
"""So many pictures are taken from a video unless `every` says otherwise."""


class ImageSource(Mapping[str, Image]):
    """Names of pictures in order, and the pictures, each read anew when it is asked for."""

    def __init__(self, readers: Mapping[str, Callable[[], Image]]):
        self._readers = dict(readers)

    def __getitem__(self, name: str) -> Image:
        return self._readers[name]()

    def __iter__(self) -> Iterator[str]:
        return iter(self._readers)

    def __len__(self) -> int:
        return len(self._readers)


def open_images(
    paths: Sequence[Path | str], *, every: int | None = None, topic: str | None = None
) -> ImageSource:
    """All pictures that `paths` name: files, folders, patterns such as ``"set/*.png"``, videos, ROS bags.

    They come in natural order (``2`` before ``10``), each once however often it is named. Pictures
    are named by their files, or by their paths where two files have one name. Of a video every `every`-th
    frame is taken; without it, the sharpest frame of each of `VIDEO_PICTURES` equal stretches. A bag is a
    video; `topic` says which one where it holds several.

    Raises NoImages for paths that hold none, UnreadableImage and BadBag for videos and bags that cannot be
    read; files are read later, and raise then.
    """
    if every is not None and every < 1:
        raise BadParameter("every", every, "a whole number from 1 on")
    files: dict[str, Path] = {}
    for path in paths:
        found = _expanded(path)
        if not found:
            raise NoImages([path])
        for file in found:
            files.setdefault(os.path.realpath(file), file)
    if topic is not None and not any(map(is_bag, files.values())):
        raise BadParameter("topic", topic, "left out: no ROS bag is given")
    ordered = sorted(files.values(), key=lambda file: _natural(str(file)))
    shared = len({file.name for file in ordered}) < len(ordered)
    readers: dict[str, Callable[[], Image]] = {}
    for file in ordered:
        name = str(file) if shared else file.name
        if file.suffix.lower() in VIDEO_SUFFIXES:
            readers |= _video_readers(file, name, every)
        elif is_bag(file):
            readers |= _bag_readers(Bag(file, topic), name, every)
        else:
            readers[name] = _reader(file)
    if not readers:
        raise NoImages(paths)
    return ImageSource(readers)


def read_image(path: Path | str) -> Image:
    """The picture in a file as 8 bits, grey or blue-green-red.

    Any turn noted in EXIF is ignored: the sensor's own rows and columns are what a calibration
    is about, and all pictures of one camera keep one size. Samples of 16 bits are scaled to 8, from the
    least of 10, 12, 14 or 16 bits that holds them; transparency is dropped. Raises UnreadableImage.
    """
    return _eight_bits(path, decoded(path, UnreadableImage))


def decoded(path: Path | str, refuse: Refusal) -> np.ndarray:
    """The samples in a file as they are. `refuse` makes the error for a file that is no picture."""
    # OpenCV itself does not open every path that Python does.
    data = read_bytes(path, refuse, LARGEST_PICTURE)
    if not data:
        raise refuse(path, "the file is empty")
    if _is_cut_off(data):
        raise refuse(path, "the file ends too early")
    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except (cv2.error, MemoryError) as error:
        raise refuse(path, _reason(error)) from error
    if image is None:
        raise refuse(path, "not a known picture format, or damaged")
    return image


def _expanded(path: Path | str) -> list[Path]:
    """The files a path stands for; empty where there are none."""
    place = Path(path).expanduser()
    if place.is_dir() and not is_bag(place):
        return [
            file
            for file in place.iterdir()
            if file.suffix.lower() in IMAGE_SUFFIXES and file.is_file() and not file.name.startswith(".")
        ]
    if place.exists():
        return [place]
    # Path.glob takes no absolute patterns.
    return [Path(name) for name in glob.glob(str(place), recursive=True) if Path(name).is_file()]  # noqa: PTH207


def _natural(text: str) -> list[tuple[int, int, str]]:
    """Sort key in which numbers count as numbers."""
    parts = re.split(r"(\d+)", text.casefold())
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts]


def _reader(file: Path) -> Callable[[], Image]:
    return lambda: read_image(file)


def _is_cut_off(data: bytes) -> bool:
    """Whether a JPEG or PNG lacks its end mark: decoders then fill the rest with grey and say nothing."""
    if data.startswith(b"\x89PNG\r\n\x1a\n"):
        return _png_is_cut_off(data)
    if not data.startswith(b"\xff\xd8\xff"):
        return False
    at = 2
    while at + 4 <= len(data) and data[at] == 0xFF:
        marker, length = data[at + 1], int.from_bytes(data[at + 2 : at + 4])
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):  # a frame's size
            height, width = int.from_bytes(data[at + 5 : at + 7]), int.from_bytes(data[at + 7 : at + 9])
            if width * height > DENSEST * len(data):
                return True
        if marker == 0xDA:  # the scan: from here on, a bare end mark is one
            return data.find(b"\xff\xd9", at) < 0
        at += 1 if marker == 0xFF else 2 + length
    return True


def _png_is_cut_off(data: bytes) -> bool:
    width, height = int.from_bytes(data[16:20]), int.from_bytes(data[20:24])
    if width * height > 8 * DENSEST * len(data):
        return True
    at = 8
    while at + 12 <= len(data):
        length, kind = int.from_bytes(data[at : at + 4]), data[at + 4 : at + 8]
        at += 12 + length
        if kind == b"IEND":
            return at > len(data)
    return True


def _eight_bits(path: Path | str, image: np.ndarray) -> Image:
    if image.dtype != np.uint8:
        if image.dtype != np.uint16:
            raise UnreadableImage(path, f"samples are {image.dtype}, not 8 or 16 bits")
        bits = next(bits for bits in (10, 12, 14, 16) if int(image.max()) < 2**bits)
        grey = (np.arange(2**bits, dtype=np.float32) * (255 / (2**bits - 1)) + 0.5).astype(np.uint8)
        eight = np.empty(image.shape, dtype=np.uint8)
        for row, samples in enumerate(image):  # indices are eight times as large as the picture
            eight[row] = grey[samples]
        image = eight
    if image.ndim == 3 and image.shape[2] == 1:
        return image[..., 0]
    return np.ascontiguousarray(image[..., :3]) if image.ndim == 3 else image


def _video_readers(file: Path, name: str, every: int | None) -> dict[str, Callable[[], Image]]:
    """Chosen frames of a video."""
    video = open_video(file, UnreadableImage)

    def frames() -> Iterator[Callable[[], Image | None]]:
        while video.grab():
            yield retrieved

    def retrieved() -> Image | None:
        readable, frame = video.retrieve()
        return frame if readable else None

    try:
        readers = _chosen(frames(), name, int(video.get(cv2.CAP_PROP_FRAME_COUNT)), every)
    finally:
        video.release()
    if not readers:
        raise UnreadableImage(file, "no frame of this video can be decoded")
    return readers


def _bag_readers(bag: Bag, name: str, every: int | None) -> dict[str, Callable[[], Image]]:
    """Chosen pictures of a bag's topic."""
    return _chosen((decode for _, decode in bag.pictures()), name, bag.frame_count, every)


def _chosen(
    frames: Iterable[Callable[[], Image | None]], name: str, total: int, every: int | None
) -> dict[str, Callable[[], Image]]:
    """Every `every`-th frame, or the sharpest of each stretch, kept losslessly compressed.

    Seeking in a video is not exact.
    """
    stretch = every or max(1, total // VIDEO_PICTURES)
    kept: dict[int, tuple[float, int, bytes]] = {}
    for index, decode in enumerate(frames):
        frame = decode() if every is None or index % every == 0 else None
        if frame is None:
            continue
        place = index // stretch
        score = 0.0 if every else _sharpness(frame)
        if place not in kept or score > kept[place][0]:
            kept[place] = (score, index, cv2.imencode(".png", frame)[1].tobytes())
        if every is None and len(kept) > 2 * VIDEO_PICTURES:  # longer than its header says
            stretch *= 2
            kept = _merged(kept)
    return {f"{name}#{index:06d}": _decoder(data) for _, index, data in kept.values()}


def _merged(kept: Mapping[int, tuple[float, int, bytes]]) -> dict[int, tuple[float, int, bytes]]:
    """The sharper frame of every two stretches."""
    fewer: dict[int, tuple[float, int, bytes]] = {}
    for place, found in kept.items():
        fewer[place // 2] = max(fewer.get(place // 2, found), found)
    return fewer


def _decoder(data: bytes) -> Callable[[], Image]:
    def decode() -> Image:
        frame = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
        assert frame is not None, "we encoded it ourselves"
        return frame

    return decode


def _sharpness(frame: Image) -> float:
    """Mean square of the Laplacian, which blur takes away first."""
    grey = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY) if frame.ndim == 3 else frame
    return float((cv2.Laplacian(grey, cv2.CV_32F) ** 2).mean())


def _reason(error: Exception) -> str:
    """The telling part of OpenCV's message."""
    text = str(getattr(error, "err", "") or error)
    return "it is too large" if "PIXELS" in text or "pixels" in text else " ".join(text.split())[:120]
