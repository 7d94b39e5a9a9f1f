"""Frames come out of any pieces of bytes, whole or not at all."""

import zlib
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from vision_robot.arm.stream import Frame, FrameReader
from vision_robot.arm.stream.frame import LONGEST_FRAME

FRAMES = st.builds(
    Frame, st.integers(0, 255), st.integers(0, 65535), st.integers(0, 65535), st.binary(max_size=200)
)


def in_pieces(data: bytes, cuts: list[int]) -> list[bytes]:
    at = [0, *sorted(cut % (len(data) + 1) for cut in cuts), len(data)]
    return [data[a:b] for a, b in pairwise(at)]


@given(st.lists(FRAMES, max_size=4), st.lists(st.integers(0), max_size=8))
def test_frames_survive_any_cutting(frames, cuts):
    reader = FrameReader()
    data = b"".join(frame.encode() for frame in frames)
    assert [frame for piece in in_pieces(data, cuts) for frame in reader.feed(piece)] == frames
    assert reader.damaged == 0


@given(FRAMES, st.data())
def test_a_damaged_frame_is_dropped_and_the_next_one_read(frame, data):
    spoiled = bytearray(frame.encode())
    at = data.draw(st.integers(1, len(spoiled) - 2))
    spoiled[at] ^= data.draw(st.integers(1, 255))
    reader = FrameReader()
    got = list(reader.feed(bytes(spoiled) + frame.encode()))
    assert got == [frame]
    assert reader.damaged >= 1


@given(FRAMES, st.data())
def test_lost_bytes(frame, data):
    spoiled = bytearray(frame.encode())
    del spoiled[data.draw(st.integers(1, len(spoiled) - 2))]
    reader = FrameReader()
    assert list(reader.feed(bytes(spoiled) + frame.encode())) == [frame]


@given(st.binary(max_size=2000))
def test_noise_is_no_frame_and_memory_stays_bounded(noise):
    reader = FrameReader()
    assert list(reader.feed(noise)) == []
    assert len(reader.pending) <= LONGEST_FRAME + 1
    frame = Frame(2, 3, 4, b"joints")
    assert list(reader.feed(frame.encode())) == [frame]


def test_bytes_laid_out_by_hand():
    body = bytes([2, 0x34, 0x12, 0x01, 0x00, 0xAA])
    check = zlib.crc32(body).to_bytes(4, "little")
    assert 0 not in check
    stuffed = bytes([5, 2, 0x34, 0x12, 0x01, 6, 0xAA]) + check
    assert Frame(2, 0x1234, 1, b"\xaa").encode() == b"\0" + stuffed + b"\0"
    assert zlib.crc32(b"123456789") == 0xCBF43926
