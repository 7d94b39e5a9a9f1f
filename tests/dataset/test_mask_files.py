"""Masks: pictures of ids and COCO's run lengths, there and back."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.dataset.mask_files import decode_runs, encode_ids, encode_runs, read_ids
from vision_robot.errors import BadParameter, BadTable


@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.2, 0.8, 1.0]))
def test_runs_there_and_back(width, height, seed, share):
    mask = np.random.default_rng(seed).random((height, width)) < share
    counts = encode_runs(mask)
    assert sum(counts) == mask.size
    assert all(count > 0 for count in counts[1:])
    assert (decode_runs(counts, (width, height)) == mask).all()


@given(st.integers(0, 2**32 - 1))
def test_runs_of_the_columns_that_hold_the_mask_are_those_of_all(seed):
    mask = np.zeros((6, 12), dtype=bool)
    mask[:, 4:8] = np.random.default_rng(seed).random((6, 4)) < 0.6
    assert encode_runs(mask, slice(3, 9)) == encode_runs(mask)


def test_runs_by_hand():
    """COCO counts down the columns and begins with what is not of the mask."""
    assert encode_runs(np.array([[0, 1], [0, 1], [1, 0]], dtype=bool)) == [2, 3, 1]
    assert encode_runs(np.array([[1, 0]], dtype=bool)) == [0, 1, 1]
    assert encode_runs(np.zeros((2, 3), dtype=bool)) == [6]


def test_runs_that_do_not_add_up_are_refused():
    with pytest.raises(BadParameter, match="6 in all"):
        decode_runs([2, 3], (3, 2))
    with pytest.raises(BadParameter):
        decode_runs([8, -2], (3, 2))


@pytest.mark.parametrize("largest", [3, 255, 256, 60000])
def test_ids_there_and_back(tmp_path, largest):
    ids = np.array([[0, 1], [2, largest]])
    (tmp_path / "a.png").write_bytes(encode_ids(ids))
    assert (read_ids(tmp_path / "a.png") == ids).all()


def test_what_is_no_picture_of_ids_is_refused(tmp_path):
    with pytest.raises(BadParameter):
        encode_ids(np.array([[-1]]))
    with pytest.raises(BadTable, match="no such file"):
        read_ids(tmp_path / "none.png")
    (tmp_path / "colour.png").write_bytes(cv2.imencode(".png", np.zeros((3, 3, 3), np.uint8))[1].tobytes())
    with pytest.raises(BadTable, match="grey"):
        read_ids(tmp_path / "colour.png")
    (tmp_path / "broken.png").write_bytes(b"PNG?")
    with pytest.raises(BadTable, match="not a known picture format"):
        read_ids(tmp_path / "broken.png")
