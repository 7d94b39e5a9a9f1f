"""OTB's layout: one object, boxes between commas, tabs or blanks."""

import pytest

from tests.dataset.folders import otb_folder
from vision_robot.dataset import open_dataset
from vision_robot.errors import BadDataset, BadTable


@pytest.mark.parametrize("between", [",", "\t", " "])
def test_boxes_count_pixels_from_one(tmp_path, between):
    rows = "\n".join(between.join(row.split()) for row in ("1 1 4 6", "2 3 4 6", "0 0 0 0"))
    ball = open_dataset(otb_folder(tmp_path, rows))
    assert (ball.layout, ball.name, ball.size, len(ball)) == ("otb", "Ball", (40, 30), 3)
    assert ball.truth.frame.tolist() == [0, 1]
    assert ball.truth.box_px.tolist() == [[-0.5, -0.5, 4, 6], [0.5, 1.5, 4, 6]]
    assert ball.truth.centroid_px[0].tolist() == [1.5, 2.5]
    assert [int(frame.image[0, 0, 0]) for frame in ball.frames(1)] == [10, 20]


def test_two_objects_have_two_files(tmp_path):
    folder = otb_folder(tmp_path, "")
    (folder / "groundtruth_rect.txt").unlink()
    for i in (1, 2):
        (folder / f"groundtruth_rect.{i}.txt").write_text(f"{i},1,4,6\nNaN,NaN,NaN,NaN\n")
    assert open_dataset(folder).truth.id.tolist() == [1, 2]


@pytest.mark.parametrize(
    ("rows", "why"),
    [("1,1,4\n", "line 1 has 3 numbers"), ("1,1,4,6\n" * 4, "line 4 is one too many"), ("a,1,4,6\n", "'a'")],
)
def test_wrong_labels_are_refused(tmp_path, rows, why):
    with pytest.raises(BadTable, match=why):
        open_dataset(otb_folder(tmp_path, rows))


def test_frames_of_another_size_are_refused_when_they_come(tmp_path):
    import cv2
    import numpy as np

    folder = otb_folder(tmp_path, "1,1,4,6\n")
    cv2.imwrite(str(folder / "img" / "0002.png"), np.zeros((9, 9, 3), np.uint8))
    with pytest.raises(BadDataset, match=r"0002.png is 9x9 px, the dataset 40x30 px"):
        list(open_dataset(folder).frames())
    assert open_dataset(folder).frame(2).index == 2
