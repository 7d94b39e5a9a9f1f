"""Payloads are laid out as the table says."""

import struct

import numpy as np
import pytest

from vision_robot.arm.stream.messages import (
    VERSION,
    Answer,
    Status,
    Welcome,
    hello,
    joints_payload,
    pose_payload,
)
from vision_robot.geometry import SE3


def test_what_the_computer_says():
    assert hello(5, 0x01020304, 0.5) == bytes([VERSION, 5, 4, 3, 2, 1, 0xF4, 0x01])
    assert joints_payload(1.5, np.array([1.0, -2.0])) == struct.pack("<Iff", 1500, 1, -2)
    pose = SE3.from_rotvec(np.array([0.1, 0.2, -0.3]), np.array([4.0, 5, 6]))
    assert struct.unpack("<I6f", pose_payload(0, pose)) == (
        0,
        *np.array([4, 5, 6, 0.1, 0.2, -0.3], "f4").tolist(),
    )


def test_what_the_microcontroller_says():
    welcome = Welcome.decode(struct.pack("<BBBIff", 0, VERSION, 2, 77, 0.5, -1))
    assert welcome is not None
    assert (welcome.status, welcome.joints, welcome.fingerprint) == (Status.DONE, 2, 77)
    assert welcome.q.tolist() == [0.5, -1]
    answer = Answer.decode(struct.pack("<Bffff", 2, 0.5, -1, 0.25, 0.125), 2)
    assert answer is not None
    assert answer.status is Status.UNREACHABLE
    assert answer.q.tolist() == [0.5, -1]
    assert (answer.position_error_m, answer.orientation_error_rad) == (0.25, 0.125)


def test_another_version_is_told_from_a_broken_message():
    other = Welcome.decode(bytes([7, VERSION + 1, 5, 1, 2]))
    assert other is not None
    assert other.version == VERSION + 1
    assert Welcome.decode(bytes([7, VERSION, 5, 1, 2])) is None
    assert Welcome.decode(b"") is None


@pytest.mark.parametrize("length", [0, 9, 16, 18])
def test_answers_of_the_wrong_length(length):
    assert Answer.decode(bytes(length), 2) is None


def test_unknown_status():
    assert Answer.decode(bytes([99]) + bytes(16), 2) is None


def test_every_status_is_explained():
    assert all(status.meaning for status in Status)
