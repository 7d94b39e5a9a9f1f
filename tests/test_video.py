"""Videos: lossless where it is promised, streamed, whole or absent, and bad files named."""

from pathlib import Path

import numpy as np
import pytest

from vision_robot.errors import BadParameter, BadVideo
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
