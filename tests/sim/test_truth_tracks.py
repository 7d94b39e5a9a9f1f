"""Truth of frames becomes a table of tracks that survives its CSV."""

import numpy as np
import pytest

from vision_robot.geometry import Camera
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import CellDesign, Item, Lights, look_at
from vision_robot.sim.paths import Straight
from vision_robot.sim.truth import TruthRenderer
from vision_robot.sim.truth_tracks import truth_tracks
from vision_robot.tracks import Tracks

CAMERA = Camera(160, 120, 150, 150, 79.5, 59.5)
TIMES = [0.0, 0.5, 1.0, 1.5, 2.0]


@pytest.fixture(scope="module")
def tracks() -> Tracks:
    items = (
        Item("spinning", path=Straight((0.0, 0.0, 0.0, 3.0), (0.02, -0.03, 0.0, 2.0))),
        Item("leaving", "disc", (0.04, 0.01), path=Straight((0.1, 0.1, 0.0, 0.0), (0.0, 0.4, 0.0, 0.0))),
    )
    cell = Cell(CellDesign(items=items, lights=Lights(shadows=False)))
    frames = []
    with TruthRenderer(cell, look_at(CAMERA, (0, 0, 0.5))) as eye:
        for time_s in TIMES:
            cell.at(time_s)
            frames.append((time_s, eye.frame().objects))
    return truth_tracks(frames)


def test_a_row_for_each_thing_and_frame(tracks):
    assert len(tracks) == 10
    assert tracks.frame.tolist() == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4]
    assert tracks.id.tolist() == [1, 2] * 5
    assert tracks.time_s[::2].tolist() == TIMES


def test_yaw_runs_on_and_positions_are_the_path(tracks):
    one = tracks.rows(tracks.id == 1)
    assert one.yaw_rad == pytest.approx(3.0 + 2.0 * np.array(TIMES))  # past half a turn, twice
    assert one.position_m[:, 0] == pytest.approx(0.02 * np.array(TIMES))
    assert one.velocity_m_s == pytest.approx(np.tile([0.02, -0.03], (5, 1)))
    assert one.extra["z_mm"] == pytest.approx(np.full(5, 4.0))
    assert np.hypot(one.extra["qw"], one.extra["qz"]) == pytest.approx(np.ones(5))
    assert one.extra["wz_rad_s"] == pytest.approx(np.full(5, 2.0))


def test_what_left_the_picture_keeps_its_row(tracks):
    two = tracks.rows(tracks.id == 2)
    assert np.isnan(two.yaw_rad).all()  # a disc has none
    assert two.extra["occluded"][0] < 0.01
    assert two.extra["occluded"][-1] == 1
    assert two.extra["truncated"][-1] == 1
    assert np.isnan(two.centroid_px[-1]).all()
    assert two.area_px[-1] == 0
    assert two.position_m[-1] == pytest.approx((0.1, 0.9))


def test_it_survives_the_csv(tracks):
    again = Tracks.from_csv(tracks.to_csv())
    for name, column in tracks.columns().items():
        assert again.columns()[name] == pytest.approx(column, abs=2e-6, nan_ok=True), name


def test_no_frames_give_an_empty_table():
    assert len(truth_tracks([])) == 0
