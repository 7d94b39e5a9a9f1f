"""Pictures are read from whatever a person may point at, and damage is named."""

import cv2
import numpy as np
import pytest

from vision_robot.errors import BadParameter, NoImages, UnreadableImage
from vision_robot.images import open_images, read_image

RNG = np.random.default_rng(0)
COLOUR = cv2.GaussianBlur(RNG.integers(0, 255, (48, 64, 3), dtype=np.uint8), (0, 0), 2)
GREY = COLOUR[..., 1].copy()


def save(path, image=COLOUR, *options):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(cv2.imencode(path.suffix, image, *options)[1].tobytes())
    return path


def test_folder_in_natural_order(tmp_path):
    """2 before 10; only pictures; nothing hidden; nothing from below."""
    for name in ("view10.png", "view2.PNG", "view1.jpg", ".hidden.png", "deeper/view3.png"):
        save(tmp_path / name)
    (tmp_path / "notes.txt").write_text("no picture")
    assert list(open_images([tmp_path])) == ["view1.jpg", "view2.PNG", "view10.png"]


def test_patterns_files_and_folders_name_each_picture_once(tmp_path):
    """However often a file is named, and by whichever way, a link included."""
    for name in ("a1.png", "a2.png", "b1.png"):
        save(tmp_path / name)
    (tmp_path / "link.png").symlink_to(tmp_path / "a1.png")
    given = [tmp_path / "a2.png", f"{tmp_path}/a*.png", str(tmp_path / "." / "a1.png")]
    assert list(open_images(given)) == ["a1.png", "a2.png"]
    assert len(open_images([tmp_path, tmp_path])) == 3


def test_equal_names_in_two_folders_stay_apart(tmp_path):
    """Then paths are the names."""
    paths = [save(tmp_path / side / "view.png") for side in ("left", "right")]
    assert list(open_images(paths)) == [str(path) for path in paths]


def test_recursive_pattern(tmp_path):
    """Two stars reach into folders."""
    save(tmp_path / "a" / "1.png")
    save(tmp_path / "a" / "b" / "2.png")
    assert list(open_images([f"{tmp_path}/**/*.png"])) == ["1.png", "2.png"]


def test_strange_names_are_no_obstacle(tmp_path):
    """Spaces, umlauts, brackets and Chinese."""
    path = save(tmp_path / "mein Büro [2]" / "фото 图像 1.png")
    assert np.array_equal(read_image(path), COLOUR)
    assert list(open_images([path])) == ["фото 图像 1.png"]


def test_pictures_are_read_when_asked_for(tmp_path):
    """Opening reads no picture; asking for a damaged one raises."""
    save(tmp_path / "a.png")
    (tmp_path / "b.png").write_bytes(b"")
    source = open_images([tmp_path])
    assert len(source) == 2
    assert source["a.png"].shape == (48, 64, 3)
    with pytest.raises(UnreadableImage, match=r"b\.png.*empty"):
        source["b.png"]


def test_nothing_there(tmp_path):
    """No file, an empty folder, a pattern that matches nothing, no path at all."""
    for paths in ([tmp_path / "no.png"], [tmp_path], [f"{tmp_path}/*.jpg"], []):
        with pytest.raises(NoImages):
            open_images(paths)


@pytest.mark.parametrize("suffix", [".jpg", ".png"])
def test_cut_off_files_are_noticed(tmp_path, suffix):
    """Decoders fill what is missing with grey; a calibration must not."""
    path = save(tmp_path / f"whole{suffix}", RNG.integers(0, 255, (200, 200, 3), dtype=np.uint8))
    data = path.read_bytes()
    for share in (0.9, 0.5, 0.1):
        path.write_bytes(data[: int(share * len(data))])
        with pytest.raises(UnreadableImage, match="ends too early"):
            read_image(path)


def test_jpeg_with_something_after_its_end_is_whole(tmp_path):
    """Cameras append previews."""
    path = save(tmp_path / "a.jpg")
    path.write_bytes(path.read_bytes() + b"\x00" * 100)
    assert read_image(path).shape == (48, 64, 3)


def test_text_is_no_picture(tmp_path):
    """Whatever it is called."""
    for name in ("a.png", "b.jpg", "c.txt"):
        (tmp_path / name).write_text("this is not a picture")
        with pytest.raises(UnreadableImage, match="not a known picture format"):
            read_image(tmp_path / name)


def test_unreadable_place(tmp_path):
    """A missing file names itself."""
    with pytest.raises(UnreadableImage, match=r"gone\.png"):
        read_image(tmp_path / "gone.png")


def test_kinds_of_samples(tmp_path):
    """Grey stays grey, alpha is dropped, 16 and 12 bits become 8."""
    assert np.array_equal(read_image(save(tmp_path / "g.png", GREY)), GREY)
    alpha = np.dstack([COLOUR, np.full(GREY.shape, 255, np.uint8)])
    assert np.array_equal(read_image(save(tmp_path / "a.png", alpha)), COLOUR)
    deep = GREY.astype(np.uint16) * 257
    deep[0, 0] = 65535
    assert np.abs(read_image(save(tmp_path / "d.png", deep)).astype(int)[1:] - GREY[1:]).max() == 0
    twelve = GREY.astype(np.uint16) * 16
    twelve[0, 0] = 4095
    assert np.abs(read_image(save(tmp_path / "t.png", twelve)).astype(int)[1:] - GREY[1:]).max() <= 1
    with pytest.raises(UnreadableImage, match="float32"):
        read_image(save(tmp_path / "f.tiff", GREY.astype(np.float32)))


def test_exif_turns_are_ignored(tmp_path):
    """A photo taken upright keeps the sensor's rows and columns."""
    data = save(tmp_path / "turned.jpg").read_bytes()
    header, entry = (
        b"Exif\x00\x00MM\x00*\x00\x00\x00\x08",
        b"\x01\x12\x00\x03\x00\x00\x00\x01\x00\x06\x00\x00",
    )
    exif = header + b"\x00\x01" + entry + bytes(4)
    segment = b"\xff\xe1" + (len(exif) + 2).to_bytes(2) + exif
    (tmp_path / "turned.jpg").write_bytes(data[:2] + segment + data[2:])
    turned = cv2.imread(str(tmp_path / "turned.jpg"))
    assert turned is not None
    assert turned.shape == (64, 48, 3)
    assert read_image(tmp_path / "turned.jpg").shape == (48, 64, 3)


def test_too_large_a_picture_is_refused_not_crashed_on(tmp_path):
    """A header that promises 100 000 x 100 000 pixels."""
    data = bytearray(save(tmp_path / "huge.png").read_bytes())
    data[16:24] = (100_000).to_bytes(4) * 2
    import zlib

    data[29:33] = zlib.crc32(bytes(data[12:29])).to_bytes(4)
    (tmp_path / "huge.png").write_bytes(data)
    with pytest.raises(UnreadableImage):
        read_image(tmp_path / "huge.png")


@pytest.fixture
def clip(tmp_path):
    """130 frames whose grey level is their number; every third one is sharp, the rest blurred."""
    path = tmp_path / "clip.avi"
    video = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"FFV1"), 25, (64, 48))
    for i in range(130):
        frame = np.full((48, 64, 3), i, np.uint8)
        frame[::4] += np.uint8(60 if i % 3 == 1 else 5)
        video.write(frame)
    video.release()
    return path


def number(image) -> int:
    return round(float(image[2::4].mean()))


def test_video_every_nth_frame(clip):
    """Frames 0, 40, 80, 120, named by their numbers."""
    source = open_images([clip], every=40)
    assert list(source) == [f"clip.avi#{i:06d}" for i in (0, 40, 80, 120)]
    assert [
        abs(number(image) - i) <= 2 for i, image in zip((0, 40, 80, 120), source.values(), strict=True)
    ] == [True] * 4
    with pytest.raises(BadParameter):
        open_images([clip], every=0)


def test_video_sharpest_frames(clip, monkeypatch):
    """One frame from each stretch, the sharpest."""
    monkeypatch.setattr("vision_robot.images.VIDEO_PICTURES", 43)
    source = open_images([clip])
    assert len(source) in (43, 44)
    assert all(int(name[-6:]) % 3 == 1 for name in list(source)[:43])


def test_damaged_video(tmp_path):
    """Text in a video's clothes."""
    (tmp_path / "a.mp4").write_text("nothing")
    with pytest.raises(UnreadableImage, match="video"):
        open_images([tmp_path / "a.mp4"])
