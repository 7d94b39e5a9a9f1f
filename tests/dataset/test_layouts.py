"""The choice among layouts, and a dataset.json that is not as it should be."""

import json

import pytest

from tests.dataset.folders import otb_folder, pictures
from vision_robot.dataset import LAYOUTS, open_dataset
from vision_robot.errors import BadDataset, BadParameter, BadTable


def test_every_layout_is_there_to_be_asked_for(tmp_path):
    for layout in LAYOUTS:
        with pytest.raises((BadDataset, BadTable)):
            open_dataset(tmp_path, layout)
    assert open_dataset(otb_folder(tmp_path, "1,1,4,6"), "otb").layout == "otb"


def test_what_is_no_dataset_is_refused_with_what_would_be_one(tmp_path):
    with pytest.raises(BadDataset, match=r"dataset.json \(vr\), gt/gt.txt \(mot\)"):
        open_dataset(tmp_path)
    with pytest.raises(BadDataset, match="no such folder"):
        open_dataset(tmp_path / "none")
    with pytest.raises(BadParameter, match="vr, mot, otb, middlebury"):
        open_dataset(tmp_path, "kitti")


GOOD = {
    "schema": "vr.dataset/1",
    "recipe": "made",
    "fps": 10,
    "size": [40, 30],
    "frames": {"pattern": "frames/{:02d}.png", "count": 2},
    "camera": {
        "width": 40, "height": 30, "fx": 50, "fy": 50, "cx": 20, "cy": 15, "skew": 0, "model": "pinhole",
        "distortion": [],
    },
    "objects": [{"id": 1, "name": "ball"}],
    "truth": {"tracks": "tracks.csv"},
}  # fmt: skip


def made(folder, **changes):
    pictures(folder / "frames", ["00.png", "01.png"])
    (folder / "tracks.csv").write_text("frame,id,u_px,v_px\n0,1,3,4\n")
    (folder / "dataset.json").write_text(json.dumps({**GOOD, **changes}))
    return folder


def test_the_least_that_is_a_dataset_of_ours(tmp_path):
    data = open_dataset(made(tmp_path) / "dataset.json")
    assert data.camera is not None
    assert data.camera.fx == 50
    assert data.cam_from_station is None
    assert data.truth.centroid_px.tolist() == [[3, 4]]
    assert data.objects[0].name == "ball"
    assert [frame.time_s for frame in data.frames()] == [0, 0.1]
    with pytest.raises(BadParameter, match="from 0 to 1"):
        data.frame(2)


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"schema": "coco"}, "schema"),
        ({"frames": {"count": 2}}, "'pattern' is missing"),
        ({"frames": {"pattern": "../{:02d}.png", "count": 2}}, "pattern"),
        ({"frames": {"pattern": "/etc/{:02d}.png", "count": 2}}, "pattern"),
        ({"frames": {"pattern": "frames/{0.__class__}.png", "count": 2}}, "pattern"),
        ({"fps": "fast"}, "fast"),
        ({"camera": {"width": 40}}, "fx"),
        ({"objects": ["ball"]}, "not as this tool writes it"),
        ({"views": []}, "no views"),
    ],
)
def test_a_damaged_dataset_json_is_refused_by_name(tmp_path, changes, why):
    with pytest.raises(BadDataset, match=why):
        open_dataset(made(tmp_path, **changes))


def test_no_json_and_no_frames(tmp_path):
    folder = made(tmp_path)
    (folder / "frames" / "01.png").unlink()
    with pytest.raises(BadDataset, match=r"frame 1 is missing: there is no 01.png"):
        list(open_dataset(folder).frames())
    (folder / "dataset.json").write_text("{")
    with pytest.raises(BadDataset, match="line 1"):
        open_dataset(folder)
