"""What an answer is judged by: labelled frames, ignored labels; and what is shown to who must be shown it."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from vision_robot.dataset import Dataset, open_dataset
from vision_robot.errors import BadDataset
from vision_robot.evaluate.tracking.examples import examples_of
from vision_robot.evaluate.tracking.labelled import judged, labelled_frames, without_ignored
from vision_robot.tracks import Tracks


def boxes(*rows: tuple[int, int, float, float]) -> Tracks:
    """Frame, id, left, top; 10 by 10 px each."""
    frame, id_, left, top = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    n, nan = len(rows), np.full(len(rows), np.nan)
    box = np.column_stack([left, top, np.full(n, 10.0), np.full(n, 10.0)])
    pair = np.full((n, 2), np.nan)
    return Tracks(frame, frame / 10, id_, box[:, :2] + 5, box, np.full(n, 100.0), pair, nan, pair, pair)


def test_answers_of_ignored_labels_are_neither_right_nor_wrong():
    truth, ignored = boxes((0, 1, 0, 0), (1, 1, 0, 0)), boxes((0, 7, 50, 50), (1, 7, 2, 0))
    answer = boxes((0, 1, 1, 0), (0, 2, 51, 50), (0, 3, 90, 90), (1, 1, 0, 0))
    left = without_ignored(truth, ignored, answer)
    # The second is the ignored one's; the last fits both and the truth better.
    assert list(zip(left.frame.tolist(), left.id.tolist(), strict=True)) == [(0, 1), (0, 3), (1, 1)]
    assert without_ignored(truth, Tracks.empty(), answer) is answer


def written(folder: Path, truth: dict[int, str], frames: int = 12) -> Dataset:
    """An OTB folder of a red and a blue square; the given rows of truth, by frame, else NaN."""
    (folder / "img").mkdir(parents=True)
    for k in range(frames):
        image = np.full((60, 80, 3), 120, np.uint8)
        image[10:30, 10 + k : 30 + k] = (40, 40, 220)
        cv2.imwrite(str(folder / "img" / f"{k + 1:04d}.png"), image)
    rows = [truth.get(k, "NaN,NaN,NaN,NaN") for k in range(max(truth) + 1)]
    (folder / "groundtruth_rect.txt").write_text("\n".join(rows) + "\n")
    return open_dataset(folder)


def test_only_labelled_frames_are_judged(tmp_path):
    data = written(tmp_path / "set", {k: f"{11 + k},11,20,20" for k in range(3, 8)})
    assert labelled_frames(data) == range(3, 8)
    assert labelled_frames(data, 5) == range(5, 8)
    answer = boxes(*((k, 1, 9.5 + k, 9.5) for k in range(12)))
    truth, found = judged(data, answer)
    assert found.frame.tolist() == truth.frame.tolist() == [3, 4, 5, 6, 7]


def test_examples_are_of_the_first_frame_with_an_object(tmp_path):
    data = written(tmp_path / "set", {k: f"{11 + k},11,20,20" for k in range(3, 8)})
    shown = examples_of(data)
    assert shown.frame == 3
    np.testing.assert_allclose(shown.boxes_px, [[12.5, 9.5, 20, 20]])
    np.testing.assert_allclose(shown.points_px, [[22, 20]], atol=1)


def test_each_colour_is_shown_once(tmp_path):
    data = written(tmp_path / "set", {0: "11,11,20,20"})
    twice = Tracks.joined([data.truth, boxes((0, 2, 12, 15)), boxes((0, 3, 60, 45))])
    shown = examples_of(Dataset(**{**vars(data), "truth": twice}))
    assert len(shown.boxes_px) == 3
    assert shown.boxes_px[0].tolist() == [9.5, 9.5, 20, 20]  # the largest first
    assert len(shown.points_px) == 2  # red, and the table's grey


def test_a_set_without_objects_is_refused(tmp_path):
    data = written(tmp_path / "set", {0: "11,11,20,20"})
    with pytest.raises(BadDataset, match="no object"):
        examples_of(Dataset(**{**vars(data), "truth": Tracks.empty()}))
