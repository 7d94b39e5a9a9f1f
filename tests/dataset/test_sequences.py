"""Folders of sequences: found at any depth that sets are handed out in, told apart by their state."""

import pytest

from tests.dataset.folders import pictures
from vision_robot.dataset import open_dataset, sequences_in
from vision_robot.dataset.sequences import fingerprint
from vision_robot.errors import BadDataset


def test_one_sequence_or_all_below(tmp_path):
    for name in ("b", "a", "deep/er/c"):
        pictures(tmp_path / name, ["frame10.png", "frame11.png"])
    assert list(sequences_in(tmp_path)) == ["a", "b", "deep/er/c"]
    assert list(sequences_in(tmp_path / "a")) == ["a"]


def test_a_folder_without_any_says_what_would_mark_one(tmp_path):
    (tmp_path / "empty").mkdir()
    with pytest.raises(BadDataset, match=r"frame\*\.png"):
        sequences_in(tmp_path)
    with pytest.raises(BadDataset, match="no such folder"):
        sequences_in(tmp_path / "none")


def test_a_fingerprint_follows_the_frames(tmp_path):
    pictures(tmp_path / "a", ["frame10.png", "frame11.png"])
    before = fingerprint(open_dataset(tmp_path / "a"))
    assert fingerprint(open_dataset(tmp_path / "a")) == before
    (tmp_path / "a" / "frame11.png").write_bytes((tmp_path / "a" / "frame10.png").read_bytes() + b" ")
    assert fingerprint(open_dataset(tmp_path / "a")) != before
