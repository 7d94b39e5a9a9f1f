"""Videos: lossless where it is promised, streamed, whole or absent, and bad files named."""

import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from vision_robot.errors import BadParameter, BadVideo
from vision_robot.images import VIDEO_PICTURES, open_images
from vision_robot.video import Video, VideoWriter

RNG = np.random.default_rng(1)


def write(path: Path, frames: np.ndarray, fps: float = 20) -> Path:
    with VideoWriter(path, frames.shape[2:0:-1], fps) as video:
        for frame in frames:
            video.write(frame)
    return path


def test_ffv1_is_lossless(tmp_path):
    frames = RNG.integers(0, 256, (5, 48, 64, 3), dtype=np.uint8)
    video = Video(write(tmp_path / "a b.mkv", frames))
    assert video.size == (64, 48)
    for _ in range(2):  # each pass starts anew
        read = list(video)
        assert np.array_equal(np.stack([frame.image for frame in read]), frames)
        assert [frame.index for frame in read] == [0, 1, 2, 3, 4]
        assert np.allclose([frame.time_s for frame in read], np.arange(5) / 20, atol=1e-3)


@pytest.mark.parametrize("suffix", [".avi", ".mp4"])
def test_playable_containers_hold_every_frame(tmp_path, suffix):
    frames = np.repeat(np.arange(0, 250, 25, dtype=np.uint8), 48 * 64).reshape(10, 48, 64)
    read = [frame.image.mean() for frame in Video(write(tmp_path / f"a{suffix}", frames))]
    assert np.allclose(read, np.arange(0, 250, 25), atol=4)


def test_nothing_appears_when_writing_fails(tmp_path):
    def interrupted():
        with VideoWriter(tmp_path / "a.mkv", (64, 48), 25) as video:
            video.write(np.zeros((48, 64), np.uint8))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert not list(tmp_path.iterdir())


def test_a_frame_of_another_size_is_refused(tmp_path):
    with (
        pytest.raises(BadParameter, match="frame size"),
        VideoWriter(tmp_path / "a.mkv", (64, 48), 25) as video,
    ):
        video.write(np.zeros((40, 64), np.uint8))


def test_an_unknown_container_is_refused(tmp_path):
    with pytest.raises(BadParameter, match=r"\.mkv"):
        VideoWriter(tmp_path / "a.gif", (64, 48), 25)


@pytest.mark.parametrize("content", [None, b"", b"no video at all"])
def test_bad_files_are_named(tmp_path, content):
    path = tmp_path / "clip.mp4"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(BadVideo, match=r"clip\.mp4"):
        Video(path)


def test_the_real_traffic_video():
    import mvtbdata

    video = Video(Path(mvtbdata.__file__).parent / "images" / "traffic_sequence.mp4")
    times = [frame.time_s for frame in video]
    assert video.size == (704, 576)
    assert len(times) == 350
    assert (np.diff(times) > 0).all()


@pytest.mark.parametrize("suffix", [".avi", ".mkv", ".mp4", ".webm"])
def test_a_disk_that_takes_no_more_is_no_end_of_a_video(tmp_path, suffix):
    """OpenCV's writers say nothing of a full disk; a limit on the size of files stands for one."""
    script = (
        "import resource, sys\nimport numpy as np\n"
        "from vision_robot.errors import UnwritableOutput\nfrom vision_robot.video import VideoWriter\n"
        "noise = np.random.default_rng(0).integers(0, 256, (20, 48, 64, 3), dtype=np.uint8)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000))\n"
        "try:\n"
        "    with VideoWriter(sys.argv[1], (64, 48), 25) as video:\n"
        "        for frame in noise: video.write(frame)\n"
        "except UnwritableOutput as error:\n    print(error)\n"
    )
    path = tmp_path / f"a{suffix}"
    done = subprocess.run([sys.executable, "-c", script, path], capture_output=True, text=True, check=True)
    assert "File too large" in done.stdout
    assert not list(tmp_path.iterdir())


def test_a_video_whose_header_tells_no_length_gives_no_more_pictures_than_others(tmp_path, monkeypatch):
    frames = np.repeat(np.arange(250, dtype=np.uint8), 48 * 64).reshape(250, 48, 64)
    path = write(tmp_path / "a.mkv", frames)
    assert len(open_images([path])) <= 2 * VIDEO_PICTURES
    monkeypatch.setattr("vision_robot.images.open_video", Lengthless)
    names = list(open_images([path]))
    assert VIDEO_PICTURES <= len(names) <= 2 * VIDEO_PICTURES
    assert names == sorted(names)


class Lengthless:
    """OpenCV's reader of a stream."""

    def __init__(self, path: Path, _: object):
        self._capture = cv2.VideoCapture(str(path))
        self.grab, self.retrieve, self.release = (
            getattr(self._capture, name) for name in ("grab", "retrieve", "release")
        )

    def get(self, what: int) -> float:
        return 0.0 if what == cv2.CAP_PROP_FRAME_COUNT else self._capture.get(what)


def test_a_name_that_is_no_text_is_refused_before_it_crashes_opencv(tmp_path):
    odd = tmp_path / "caf\udce9.mkv"
    write(tmp_path / "a.mkv", np.zeros((2, 48, 64, 3), np.uint8)).rename(odd)
    with pytest.raises(BadVideo, match="no text"):
        Video(odd)
    with pytest.raises(BadVideo, match="no text"):
        VideoWriter(odd, (64, 48), 25)
