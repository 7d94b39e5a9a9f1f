"""The table of tracks: what is written is read, and a bad file is named by line and column."""

import numpy as np
import pytest

from vision_robot.errors import BadTable
from vision_robot.tracks import COLUMNS, Tracks

RNG = np.random.default_rng(2)


def table(n: int = 6) -> Tracks:
    return Tracks(
        frame=np.arange(n) // 2,
        time_s=(np.arange(n) // 2) / 25,
        id=1 + np.arange(n) % 2,
        centroid_px=RNG.uniform(0, 600, (n, 2)),
        box_px=RNG.uniform(0, 600, (n, 4)),
        area_px=RNG.uniform(10, 99, n),
        axes_px=RNG.uniform(1, 30, (n, 2)),
        yaw_rad=RNG.uniform(-4, 4, n),
        position_m=np.full((n, 2), np.nan),
        velocity_m_s=RNG.normal(size=(n, 2)),
        extra={"occluded": RNG.uniform(0, 1, n)},
    )


def test_written_and_read_again(tmp_path):
    tracks = table()
    tracks.write(tmp_path / "tracks.csv")
    again = Tracks.read(tmp_path / "tracks.csv")
    for name, column in tracks.columns().items():
        assert np.allclose(again.columns()[name], column, atol=6e-7, equal_nan=True), name
    assert (tmp_path / "tracks.csv").read_text().splitlines()[0] == ",".join([*COLUMNS, "occluded"])


def test_rows_come_sorted_and_missing_columns_are_unknown():
    tracks = Tracks.from_csv("id,frame,u_px,v_px\n2,1,5,6\n1,1,3,4\n1,0,1,2\n")
    assert tracks.frame.tolist() == [0, 1, 1]
    assert tracks.id.tolist() == [1, 1, 2]
    assert tracks.centroid_px.tolist() == [[1, 2], [3, 4], [5, 6]]
    assert np.isnan(tracks.area_px).all()


def test_rows_by_mask_and_ids():
    tracks = table()
    assert tracks.ids.tolist() == [1, 2]
    assert len(tracks.rows(tracks.id == 2)) == 3
    assert len(Tracks.empty()) == 0


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "lacks the column"),
        ("frame,id,u_px\n", "v_px"),
        ("frame,id,u_px,v_px\n1,2,3\n", "line 2 has 3 fields"),
        ("frame,id,u_px,v_px\n1,2,3,abc\n", "line 2: v_px is 'abc'"),
        ("frame,id,u_px,v_px\n1.5,2,3,4\n", "frame must be a whole number"),
        ("frame,id,u_px,v_px\n1,2,nan,4\n", "leave it empty"),
    ],
)
def test_bad_tables_are_named(text, says):
    with pytest.raises(BadTable, match=says):
        Tracks.from_csv(text)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(BadTable, match=r"none\.csv"):
        Tracks.read(tmp_path / "none.csv")
