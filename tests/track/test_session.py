"""A whole video through a tracker: from any source, to any file, in millimetres, and whatever goes wrong."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.track.drawn import Shape, frame_of, table
from tests.track.scenes import RED, SIZE, moving, rendered
from vision_robot.errors import BadFrame, BadParameter, BadVideo
from vision_robot.geometry import SE3, Camera
from vision_robot.geometry.work_plane import WorkPlane
from vision_robot.track import tracker_named
from vision_robot.track.on_plane import OnPlane
from vision_robot.track.row_writers import row_writer
from vision_robot.track.session import Session, track
from vision_robot.track.sources import CameraStream
from vision_robot.tracks import Tracks
from vision_robot.video import Frame, Video, VideoWriter

CAMERA = Camera(240, 180, 300, 305, 121, 88, 0.0, "brown5", (-0.1, 0.02, 0.001, -0.001, 0.0))
CAM_FROM_STATION = SE3.from_rotvec(np.array([2.8, 0.2, -0.1]), np.array([-0.02, 0.03, 0.6]))


@pytest.fixture(scope="module")
def frames() -> list[np.ndarray]:
    return rendered(moving, 40)


@pytest.fixture
def video(tmp_path, frames) -> Path:
    with VideoWriter(tmp_path / "moving.mkv", SIZE, 25) as writer:
        for frame in frames:
            writer.write(frame)
    return tmp_path / "moving.mkv"


def same(one: Tracks, other: Tracks) -> bool:
    pairs = zip(one.columns().values(), other.columns().values(), strict=True)
    return all(np.allclose(a, b, atol=2e-3, equal_nan=True) for a, b in pairs)


def test_file_array_list_and_generator_give_the_same(video, frames):
    def tracked(source) -> Tracks:
        return track(source, tracker_named("rgb", {"color": "red"}))

    from_file = tracked(video)
    assert len(from_file) == 40
    assert from_file.ids.tolist() == [1]
    for source in (str(video), Video(video), np.stack(frames), list(frames), (frame for frame in frames)):
        assert same(tracked(source), from_file)


def test_frames_bring_their_own_times(frames):
    times = np.cumsum(np.random.default_rng(1).uniform(0.02, 0.08, 40))
    session = Session(tracker_named("rgb", {"color": "red"}))
    steps = list(session.run(Frame(k, float(times[k]), frame) for k, frame in enumerate(frames)))
    assert any("frame rate varies" in text for _, text in session.remarks())
    assert np.allclose([step.frame.time_s for step in steps], times)
    assert session.frames == 40
    assert session.latency.quantile_ms(0.5) <= session.latency.quantile_ms(0.99)


@pytest.mark.parametrize("suffix", [".csv", ".json", ".txt"])
def test_rows_are_written_as_they_come_and_kept_after_an_interrupt(tmp_path, frames, suffix):
    path = tmp_path / f"tracks{suffix}"
    session = Session(tracker_named("rgb", {"color": "red"}))

    def interrupted() -> None:
        with row_writer(path) as writer:
            for step in session.run(iter(frames)):
                writer.write(step.final)
                if step.frame.index == 20:
                    raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    if suffix == ".csv":
        assert Tracks.read(path).frame.tolist() == list(range(19))
    elif suffix == ".json":
        rows = json.loads(path.read_text())["rows"]
        assert [row["frame"] for row in rows] == list(range(19))
        assert rows[0]["x_mm"] is None
    else:
        lines = [line.split(",") for line in path.read_text().splitlines()]
        assert [int(line[0]) for line in lines] == list(range(1, 20))
        assert {len(line) for line in lines} == {10}
    with row_writer(path):
        pass
    assert path.is_file()


def test_millimetres_on_the_plane_and_their_sigma():
    """A disc that moves on the plane with a known speed; sigma agrees with the scatter of repeated noise."""
    plane = WorkPlane.exact(CAMERA, CAM_FROM_STATION)
    truth = np.array([[-0.06 + 0.0015 * k, 0.02 + 0.0007 * k] for k in range(40)])
    pixels = plane.pixels(truth)
    shapes = [Shape(u, v, 16, 16, 0, RED) for u, v in pixels]
    frames = [frame_of(table(SIZE), [one], noise=2, seed=k) for k, one in enumerate(shapes)]
    rows = track(frames, tracker_named("rgb", {"color": "red"}), plane=plane)
    assert len(rows) == 40
    error = rows.position_m - truth
    assert np.abs(error).max() < 3e-4
    late = rows.rows(rows.frame > 15)
    assert np.allclose(np.median(late.velocity_m_s, axis=0), [0.0375, 0.0175], atol=1e-3)
    sigma = 1e-3 * np.median(late.extra["sigma_x_mm"])
    assert 0.3 < sigma / np.abs(error[16:, 0]).std() < 30


def test_yaw_on_the_plane_goes_on_as_the_rod_turns():
    plane = WorkPlane.exact(CAMERA, CAM_FROM_STATION)
    view = OnPlane(plane, SIZE)
    yaw = 0.15 * np.arange(60)
    ends = 0.02 * np.stack([np.cos(yaw), np.sin(yaw)], axis=1)
    found = []
    for k in range(60):
        a, b = plane.pixels(np.stack([ends[k], -ends[k]]))
        picture = np.arctan2(*(a - b)[::-1])
        picture = (picture + np.pi / 2) % np.pi - np.pi / 2
        none = np.full((1, 2), np.nan)
        extra = {name: np.ones(1) for name in ("vu_px_s", "vv_px_s", "sigma_px", "sigma_v_px_s")}
        row = Tracks(
            np.array([k]), np.array([k / 25]), np.array([1]), plane.pixels(np.zeros((1, 2))),
            np.zeros((1, 4)), np.ones(1), np.ones((1, 2)), np.array([picture]), none, none, extra,
        )  # fmt: skip
        found.append(view.carry(row).yaw_rad[0])
    assert np.allclose(np.array(found) - found[0], yaw, atol=0.01)


def test_a_plane_that_is_not_seen_or_another_size_is_named():
    behind = WorkPlane.exact(CAMERA, SE3.from_rotvec(np.zeros(3), np.array([0, 0, -1.0])))
    with pytest.raises(BadParameter, match="behind the camera"):
        OnPlane(behind, SIZE)
    with pytest.raises(BadParameter, match="240x180 px, the calibrated camera's"):
        OnPlane(WorkPlane.exact(CAMERA, CAM_FROM_STATION), (640, 480))


@pytest.mark.parametrize("by", [0, 3])
def test_a_camera_that_moves_is_noticed(frames, by):
    rng = np.random.default_rng(1)
    texture = rng.integers(-40, 40, (90, 120, 1)).repeat(2, 0).repeat(2, 1)
    shaken = []
    for k, frame in enumerate(frames * 2):
        picture = np.clip(frame.astype(int) + texture, 0, 255).astype(np.uint8)
        shaken.append(np.roll(picture, by, axis=1) if k >= 35 else picture)
    session = Session(tracker_named("rgb", {"color": "red"}))
    for _ in session.run(shaken):
        pass
    assert (session.camera.moved_at is not None) == (by > 0)
    told = any("the camera moved" in text for _, text in session.remarks())
    assert told == (by > 0)
    if by:
        assert session.camera.largest_px == pytest.approx(by, abs=0.3)


def test_what_goes_wrong_in_the_middle_comes_after_what_went_well(frames):
    session = Session(tracker_named("rgb", {"color": "red"}))
    seen = []

    def through() -> None:
        for step in session.run([*frames[:10], frames[10][:90], *frames[11:]]):
            seen.append(step.frame.index)

    with pytest.raises(BadFrame, match=r"frame 10 .* 240x90 px and those before are 240x180 px"):
        through()
    assert seen == list(range(10))
    assert len(session.rest()) == 2


def test_empty_sources_and_absent_cameras_are_named(tmp_path):
    tracker = tracker_named("rgb", {"color": "red"})
    with pytest.raises(BadFrame, match="the source is empty"):
        track([], tracker)
    (tmp_path / "cut.mp4").write_bytes(b"\0" * 50)
    with pytest.raises(BadVideo, match=r"cut\.mp4"):
        track(tmp_path / "cut.mp4", tracker)
    with pytest.raises(BadVideo, match="camera 77"):
        CameraStream(77)


def test_an_unplugged_camera_ends_in_an_error_with_the_frames_before(monkeypatch, frames):
    class Capture:
        def __init__(self, number: int):
            self._left = list(frames[:5])

        def isOpened(self) -> bool:
            return True

        def read(self):
            return (True, self._left.pop(0)) if self._left else (False, None)

        def release(self) -> None:
            pass

    monkeypatch.setattr("vision_robot.track.sources.cv2.VideoCapture", Capture)
    monkeypatch.setattr("vision_robot.track.sources.PAUSE_S", 0)
    stream, seen = CameraStream(0), []

    def through() -> None:
        seen.extend(frame.index for frame in stream)

    with pytest.raises(BadVideo, match=r"camera 0 .* it stopped giving frames after 4"):
        through()


def test_memory_does_not_grow_with_the_video(frames):
    """Twice the frames, no more memory: what a session keeps was all there after the first pass."""
    import tracemalloc

    session = Session(tracker_named("background", {"span_s": "1", "window": "9"}))
    tracemalloc.start()
    try:
        peaks = []
        endless = (Frame(k, k / 25, frames[k % 40]) for k in range(160))
        for step in session.run(endless):
            if step.frame.index in (79, 159):
                peaks.append(tracemalloc.get_traced_memory()[0])
    finally:
        tracemalloc.stop()
    assert peaks[1] < 1.02 * peaks[0] + 200_000
