"""Joint tables: written and read exactly, units from the header, bad rows named."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.arm import read_arm
from vision_robot.arm.stream import JointTable
from vision_robot.errors import BadTable

CHAIN = read_arm("column").chain
HEADER = "time_s,d1_m,theta2_rad,theta3_rad,theta4_rad,theta5_rad"


@given(st.lists(st.lists(st.floats(-1e9, 1e9), min_size=5, max_size=5), min_size=1, max_size=4))
def test_every_number_comes_back_exactly(rows):
    table = JointTable.of(CHAIN, np.arange(len(rows)) / 7, np.array(rows))
    again = JointTable.from_csv(table.to_csv(), CHAIN)
    assert (again.q == table.q).all()
    assert (again.time_s == table.time_s).all()
    assert table.to_csv().splitlines()[0] == HEADER


def test_units_and_order_come_from_the_header(tmp_path):
    path = tmp_path / "joints.csv"
    path.write_text("theta5_deg,note,d1_mm,theta2_deg,theta3_rad,theta4_deg,time_s\n90,a,120,180,1,-90,0.5\n")
    table = JointTable.read(path, CHAIN)
    assert np.allclose(table.q, [[0.12, np.pi, 1, -np.pi / 2, np.pi / 2]])
    assert table.time_s.tolist() == [0.5]
    table.write(tmp_path / "again.csv")
    assert (JointTable.read(tmp_path / "again.csv", CHAIN).q == table.q).all()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "lacks the column time_s"),
        (
            "time_s,d1,theta2_rad,theta3_rad,theta4_rad,theta5_rad\n",
            "lacks d1_m or d1_mm; it has time_s, d1,",
        ),
        (f"{HEADER}\n0,0,0,0,0\n", "line 2 has 5 fields"),
        (f"{HEADER}\n0,0,0,0,x,0\n", "line 2: theta4_rad is 'x'"),
        (f"{HEADER}\n0,0,0,0,nan,0\n", "not finite"),
        (f"{HEADER}\n0,0,0,0,0,0\n0,0,0,0,0,0\n", "line 3: time_s must rise"),
        (f"{HEADER}\n-1,0,0,0,0,0\n", "line 2: time_s must rise from 0"),
    ],
)
def test_bad_tables_are_named(text, says):
    with pytest.raises(BadTable, match=says):
        JointTable.from_csv(text, CHAIN)


def test_limits_are_checked_before_anything_moves():
    q = np.tile(CHAIN.limits.mean(axis=1), (3, 1))
    JointTable.of(CHAIN, np.arange(3.0), q).check(CHAIN)
    q[1, 0] = 0.5
    with pytest.raises(BadTable, match=r"joints\.csv.*line 3: d1 is 0.5 m, outside its limits 0 to 0.4 m"):
        JointTable.of(CHAIN, np.arange(3.0), q).check(CHAIN, "joints.csv")


@pytest.mark.parametrize(
    ("time", "q"), [([0, 1], np.zeros((3, 5))), ([1, 0], np.zeros((2, 5))), ([0], [[np.nan] * 5])]
)
def test_tables_made_in_python_are_checked_too(time, q):
    with pytest.raises(BadTable):
        JointTable.of(CHAIN, np.array(time, dtype=float), np.array(q))


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(BadTable, match=r"none\.csv"):
        JointTable.read(tmp_path / "none.csv", CHAIN)
