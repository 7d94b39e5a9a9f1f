"""Stuffing is undone exactly, leaves no zero, and costs what the paper says."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.arm.stream.cobs import MALFORMED, cobs_decode, cobs_encode


@given(st.binary(max_size=700) | st.integers(0, 600).map(lambda n: bytes([7]) * n))
def test_round_trip_without_zeros(data):
    stuffed = cobs_encode(data)
    assert 0 not in stuffed
    assert len(stuffed) <= len(data) + 1 + len(data) // 254
    assert cobs_decode(stuffed) == data


@pytest.mark.parametrize(
    ("data", "stuffed"),
    [
        ("", "01"),
        ("00", "0101"),
        ("0000", "010101"),
        ("001100", "01021101"),
        ("11220033", "0311220233"),
        ("11223344", "0511223344"),
        ("11000000", "0211010101"),
    ],
)
def test_examples_worked_by_hand(data, stuffed):
    assert cobs_encode(bytes.fromhex(data)).hex() == stuffed


def test_runs_about_254():
    run = bytes(range(1, 255))
    assert cobs_encode(run) == b"\xff" + run
    assert cobs_encode(b"\0" + run) == b"\x01\xff" + run
    assert cobs_encode(run + b"\xff") == b"\xff" + run + b"\x02\xff"
    assert cobs_encode(run[1:] + b"\0") == b"\xfe" + run[1:] + b"\x01"


@pytest.mark.parametrize("broken", ["", "00", "0311", "05112200", "021100"])
def test_what_is_no_encoding(broken):
    assert cobs_decode(bytes.fromhex(broken)) is MALFORMED
