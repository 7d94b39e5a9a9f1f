"""MOTChallenge's layout: a real street, pixels counted from 1, and every way a label file can be wrong."""

import numpy as np
import pytest

from tests.dataset.folders import GT, traffic_sequence
from vision_robot.dataset import open_dataset
from vision_robot.dataset.mot import mot_text, read_mot
from vision_robot.errors import BadDataset, BadTable


def test_a_real_street_reads_as_a_dataset(tmp_path):
    street = open_dataset(traffic_sequence(tmp_path))
    assert (street.layout, street.name, street.size, street.fps, len(street)) == (
        "mot",
        "street",
        (704, 576),
        25,
        4,
    )
    frames = list(street.frames())
    assert [frame.index for frame in frames] == [0, 1, 2, 3]
    assert [frame.time_s for frame in frames] == [0, 0.04, 0.08, 0.12]
    assert frames[0].image.shape == (576, 704, 3)
    assert frames[0].image.std() > 20
    truth = street.truth
    assert truth.frame.tolist() == [0, 0, 1]
    assert truth.id.tolist() == [1, 2, 1]
    # Their pixel 301 is our 300, whose left border is at 299.5.
    assert truth.box_px[0].tolist() == [299.5, 39.5, 31, 21]
    assert truth.centroid_px[0].tolist() == [315, 50]
    assert truth.extra["visible"].tolist() == [1, 0.25, 0.5]
    assert street.ignored.id.tolist() == [7]
    assert (street.camera, street.flow(0), street.masks(0), street.plane()) == (None, None, None, None)


def test_text_there_and_back(tmp_path):
    times = np.arange(4) / 25
    (tmp_path / "gt.txt").write_text(GT)
    truth, _ = read_mot(tmp_path / "gt.txt", times)
    (tmp_path / "again.txt").write_text(mot_text(truth, truth.extra["visible"]))
    again, ignored = read_mot(tmp_path / "again.txt", times)
    assert len(ignored) == 0
    assert np.array_equal(again.box_px, truth.box_px)
    assert np.array_equal(again.extra["visible"], truth.extra["visible"])


def test_rows_of_2015_have_ten_numbers_and_no_visibility(tmp_path):
    (tmp_path / "gt.txt").write_text("1,1,10,20,30,40,1,-1,-1,-1\n")
    truth, _ = read_mot(tmp_path / "gt.txt", np.zeros(1))
    assert truth.extra == {}
    assert len(truth) == 1


def test_without_seqinfo_the_frames_tell(tmp_path):
    folder = traffic_sequence(tmp_path)
    (folder / "seqinfo.ini").unlink()
    assert open_dataset(folder).fps == 30


@pytest.mark.parametrize(
    ("gt", "why"),
    [
        ("1,1,10,20,30\n", "line 1 has 5 numbers"),
        ("1,1,10,20,30,40,1\n\n2,one,10,20,30,40,1\n", "line 3: 'one' is not a number"),
        ("1.5,1,10,20,30,40,1\n", "whole numbers"),
        ("5,1,10,20,30,40,1\n", "frame 5, the sequence has 1 to 4"),
        ("0,1,10,20,30,40,1\n", "frame 0"),
        ("1,1,10,20,0,40,1\n", "a box of 0 x 40 px"),
        ("1,1,nan,20,5,40,1\n", "line 1"),
        ("1,1,10,20,30,40,1\n1,1,11,20,30,40,1\n", "line 2: object 1 a second time in frame 1"),
    ],
)
def test_wrong_labels_are_refused_with_their_line(tmp_path, gt, why):
    folder = traffic_sequence(tmp_path, gt=gt)
    with pytest.raises(BadTable, match=why):
        open_dataset(folder)


def test_incomplete_folders_are_refused(tmp_path):
    folder = traffic_sequence(tmp_path)
    (folder / "img1" / "000002.jpg").rename(folder / "img1" / "000009.jpg")
    with pytest.raises(BadDataset, match="frame 2 of 1 to 9 is missing"):
        open_dataset(folder)
    (folder / "seqinfo.ini").write_text("[Sequence]\nframeRate=fast\n")
    with pytest.raises(BadDataset, match="framerate is 'fast'"):
        open_dataset(folder)
    (folder / "seqinfo.ini").write_text("frameRate 25")
    with pytest.raises(BadDataset, match="starts with"):
        open_dataset(folder)
    (folder / "seqinfo.ini").write_text("[Sequence]\nimDir=pictures\n")
    with pytest.raises(BadDataset, match="pictures"):
        open_dataset(folder)
