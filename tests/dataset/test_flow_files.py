"""Flow files: what is written is read, in the bytes that KITTI and Middlebury define."""

import struct

import cv2
import numpy as np
import pytest

from vision_robot.dataset import FlowField, read_flow, write_flow
from vision_robot.errors import BadParameter, BadTable


def field() -> FlowField:
    rng = np.random.default_rng(0)
    flow = rng.uniform(-90, 90, (7, 9, 2)).astype(np.float32)
    flow[2, 3] = np.nan
    occluded = np.zeros((7, 9), dtype=bool)
    occluded[4, 5] = True
    return FlowField(flow, occluded)


def test_flo_keeps_every_digit_but_not_what_is_hidden(tmp_path):
    write_flow(field(), tmp_path / "a.flo")
    back = read_flow(tmp_path / "a.flo")
    assert np.array_equal(back.flow_px, field().flow_px, equal_nan=True)
    assert not back.occluded.any()


def test_png_keeps_a_128th_of_a_pixel_and_what_is_hidden(tmp_path):
    write_flow(field(), tmp_path / "a.png")
    back = read_flow(tmp_path / "a.png")
    assert np.nanmax(np.abs(back.flow_px - field().flow_px)) <= 1 / 128
    assert (back.known == field().known).all()
    assert (back.occluded == field().occluded).all()


def test_what_is_beyond_the_png_s_range_is_unknown(tmp_path):
    flow = np.zeros((2, 2, 2), dtype=np.float32)
    flow[0, 0], flow[0, 1], flow[1, 0] = (600, 0), (510, -510), (0, np.inf)
    write_flow(FlowField(flow, np.zeros((2, 2), dtype=bool)), tmp_path / "a.png")
    assert (read_flow(tmp_path / "a.png").known == [[False, True], [False, True]]).all()


def test_png_is_kitti_s(tmp_path):
    """By hand: u = 1 and v = -2 px are 64 and -128 steps from 2^15; red u, green v, blue valid."""
    flow = np.zeros((1, 2, 2), dtype=np.float32)
    flow[0, 0], flow[0, 1] = (1, -2), np.nan
    write_flow(FlowField(flow, np.zeros((1, 2), dtype=bool)), tmp_path / "a.png")
    raw = cv2.imread(str(tmp_path / "a.png"), cv2.IMREAD_UNCHANGED)
    assert raw is not None
    assert raw.dtype == np.uint16
    assert raw[0, 0, ::-1].tolist() == [32832, 32640, 1]
    assert raw[0, 1, 0] == 0
    assert raw.shape == (1, 2, 3)


def test_flo_is_middlebury_s(tmp_path):
    """By hand: the tag PIEH, width, height, then u and v row by row; more than 1e9 is unknown."""
    data = b"PIEH" + struct.pack("<ii4f", 2, 1, 0.5, -1.5, 2e9, 0.0)
    (tmp_path / "a.flo").write_bytes(data)
    back = read_flow(tmp_path / "a.flo")
    assert back.flow_px[0, 0].tolist() == [0.5, -1.5]
    assert back.known.tolist() == [[True, False]]
    write_flow(back, tmp_path / "b.flo")
    assert (tmp_path / "b.flo").read_bytes()[:20] == data[:20]


@pytest.mark.parametrize(
    ("name", "data", "why"),
    [
        ("a.flo", b"", "202021.25"),
        ("a.flo", b"PIEH" + struct.pack("<ii", 2, 2) + b"\0" * 12, "44 bytes, it has 24"),
        ("a.flo", b"PIEH" + struct.pack("<ii", -2, 2), "size is -2x2"),
        ("a.png", b"", "empty"),
        ("a.png", cv2.imencode(".png", np.zeros((4, 4), np.uint8))[1].tobytes(), "3 x 16 bits"),
        (
            "a.png",
            cv2.imencode(".png", np.zeros((40, 40, 3), np.uint16))[1].tobytes()[:-30],
            "ends too early",
        ),
    ],
)
def test_broken_files_are_refused(tmp_path, name, data, why):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(BadTable, match=why):
        read_flow(tmp_path / name)


def test_no_file_and_no_such_format(tmp_path):
    with pytest.raises(BadTable, match="no such file"):
        read_flow(tmp_path / "none.flo")
    with pytest.raises(BadParameter, match="flow file"):
        write_flow(field(), tmp_path / "a.tif")
