"""Middlebury's layout: frames and true flow, in one folder or in two side by side."""

import numpy as np
import pytest

from tests.dataset.folders import pictures
from vision_robot.dataset import FlowField, open_dataset, write_flow
from vision_robot.errors import BadDataset


def flow_file(path, size=(40, 30)) -> None:
    flow = np.full((size[1], size[0], 2), 1.25, dtype=np.float32)
    write_flow(FlowField(flow, np.zeros(flow.shape[:2], dtype=bool)), path)


@pytest.mark.parametrize("kind", ["other-data", "other-data-gray"])
def test_frames_and_flow_as_they_are_handed_out(tmp_path, kind):
    pictures(tmp_path / kind / "Grove", ["frame09.png", "frame10.png", "frame11.png"])
    flow_file(tmp_path / "other-gt-flow" / "Grove" / "flow10.flo")
    grove = open_dataset(tmp_path / kind / "Grove")
    assert (grove.layout, grove.name, len(grove), len(grove.truth)) == ("middlebury", "Grove", 3, 0)
    assert grove.flow(0) is None
    field = grove.flow(1)
    assert field is not None
    assert (field.flow_px == 1.25).all()


def test_frames_and_flow_in_one_folder(tmp_path):
    pictures(tmp_path / "a", ["frame10.png", "frame11.png"])
    flow_file(tmp_path / "a" / "flow10.flo")
    assert open_dataset(tmp_path / "a").flow(0) is not None


def test_flow_that_belongs_to_no_pair_or_has_another_size_is_refused(tmp_path):
    pictures(tmp_path / "a", ["frame10.png", "frame11.png"])
    flow_file(tmp_path / "a" / "flow11.flo")
    with pytest.raises(BadDataset, match="no pair"):
        open_dataset(tmp_path / "a")
    (tmp_path / "a" / "flow11.flo").unlink()
    flow_file(tmp_path / "a" / "flow10.flo", size=(8, 8))
    with pytest.raises(BadDataset, match="8x8 px, the frames 40x30 px"):
        open_dataset(tmp_path / "a")
