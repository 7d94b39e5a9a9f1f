"""Datasets: the same bytes however they were made, truth that holds, folders never half-written."""

import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import cv2
import numpy as np
import pytest

from vision_robot.dataset import open_dataset
from vision_robot.dataset.mask_files import decode_runs
from vision_robot.errors import BadParameter, UnwritableOutput
from vision_robot.formats import read_camera
from vision_robot.formats.work_plane import read_work_plane
from vision_robot_synth.making import synthesise
from vision_robot_synth.recipe import Recipe, read_recipe

SIZE = (96, 72)


def small(name: str = "many-objects", frames: int = 6) -> Recipe:
    return read_recipe(name).with_video(frames=frames, size=SIZE)


def digests(folder: Path) -> dict[str, str]:
    files = sorted(p for p in folder.rglob("*") if p.is_file())
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("made") / "set"
    synthesise(small(), folder, seed=4)
    return folder


def test_a_second_run_gives_the_same_bytes_and_a_third_does_nothing(made, tmp_path):
    synthesise(small(), tmp_path / "b", seed=4)
    assert digests(tmp_path / "b") == digests(made)
    again = synthesise(small(), made, seed=4)
    assert (again.frames, again.rendered) == (6, 0)
    assert {p.name for p in made.parent.iterdir()} == {"set"}


def test_two_workers_give_the_same_bytes(made, tmp_path):
    seen = []
    synthesise(
        small(), tmp_path / "b", seed=4, workers=2, progress=lambda done, total: seen.append((done, total))
    )
    assert digests(tmp_path / "b") == digests(made)
    assert seen == [(i, 6) for i in range(1, 7)]


@pytest.mark.parametrize("name", ["gripper-approach", "motion-blur", "camera-shake"])
def test_physics_shutters_and_shaking_cameras_do_not_depend_on_how_frames_are_shared_out(name, tmp_path):
    """The seams between stretches of frames, which physics crosses by a saved state, leave no trace."""
    from vision_robot_synth.making.frame_files import Workshop
    from vision_robot_synth.making.maker import Maker
    from vision_robot_synth.scene.scene import scene_of

    scene = scene_of(small(name, 7).at(0.5), 1)
    shares = {"whole": [(0, 7)], "parts": [(0, 2), (2, 3), (3, 7)], "holes": [(4, 7), (0, 4)]}
    results = {}
    for share, stretches in shares.items():
        workshop = Workshop(tmp_path / share / "set", tmp_path / share / "notes")
        with Maker(scene, workshop) as maker:
            for start, stop in stretches:
                assert list(maker.make(start, stop)) == list(range(start, stop))
        results[share] = digests(tmp_path / share)
    assert results["whole"] == results["parts"] == results["holes"]
    assert len(results["whole"]) == 7 + 7 + 7 + 6  # frames, masks, notes, flow


def test_kill_in_the_middle_then_resume_gives_the_same_bytes(tmp_path):
    """A real `kill -9` of the whole run, two workers included, at a moment when some frames are done."""
    recipe, frames = "single-rod", 24
    command = [sys.executable, "-m", "vision_robot_cli.main", "synth", recipe, "--frames", str(frames)]
    command += ["--size", "96x72", "--seed", "3", "--workers", "2", "-o"]
    run = subprocess.Popen([*command, str(tmp_path / "killed")], stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 120
    while len(list(tmp_path.glob(".killed.*.notes/[0-9]*"))) < 4 and time.monotonic() < deadline:
        assert run.poll() is None, "it was done before it could be killed"
        time.sleep(0.01)
    os.kill(run.pid, signal.SIGKILL)
    run.wait()
    assert not (tmp_path / "killed").exists()
    assert 4 <= len(list(tmp_path.glob(".killed.*.notes/[0-9]*"))) < frames
    resumed = synthesise(small(recipe, frames), tmp_path / "killed", seed=3)
    assert 0 < resumed.rendered < frames
    synthesise(small(recipe, frames), tmp_path / "whole", seed=3)
    assert digests(tmp_path / "killed") == digests(tmp_path / "whole")
    assert {p.name for p in tmp_path.iterdir()} == {"killed", "whole"}


def test_the_reader_gives_back_what_was_made(made):
    data = open_dataset(made)
    assert (data.layout, data.name, data.size, data.fps, len(data)) == ("vr", "many-objects", SIZE, 30, 6)
    assert [one.name for one in data.objects][:2] == ["rod 1", "rod 2"]
    assert data.objects[0].properties["shape"] == "pencil"
    frames = list(data.frames())
    assert len(frames) == 6
    assert all(frame.image.shape == (72, 96, 3) for frame in frames)
    assert len(data.truth) == 6 * len(data.objects)
    assert data.truth.ids.tolist() == [one.id for one in data.objects]
    plane = data.plane()
    assert plane is not None
    assert read_camera(made / "dataset.json") == data.camera == plane.camera
    assert np.allclose(
        read_work_plane(made / "dataset.json").cam_from_station.as_matrix(),
        plane.cam_from_station.as_matrix(),
    )
    assert data.flow(5) is None
    described = json.loads((made / "dataset.json").read_text())
    assert described["seed"] == 4
    assert set(described["versions"]) == {"vision_robot", "mujoco", "numpy", "opencv"}


def test_masks_boxes_and_run_lengths_agree(made):
    data = open_dataset(made)
    coco = json.loads((made / "truth/masks.json").read_text())
    masks = {i: data.masks(i) for i in range(len(data))}
    assert len(coco["images"]) == 6
    assert coco["annotations"]
    for one in coco["annotations"]:
        mask = masks[one["image_id"]]
        assert mask is not None
        runs = decode_runs(one["segmentation"]["counts"], SIZE)
        assert (runs == (mask == one["track_id"])).all()
        rows, columns = np.nonzero(runs)
        left, top, width, height = one["bbox"]
        # Pixel centres lie half a pixel inside COCO's borders.
        assert columns.min() + 0.5 >= left - 0.01
        assert columns.max() + 0.5 <= left + width + 0.01
        assert rows.min() + 0.5 >= top - 0.01
        assert rows.max() + 0.5 <= top + height + 0.01


def test_flow_leads_each_object_to_where_it_is_next(made):
    """The mean flow over an object that is seen whole twice is the way of its centroid, to 0.2 px."""
    data = open_dataset(made)
    checked = 0
    for i in range(len(data) - 1):
        field, ids = data.flow(i), data.masks(i)
        assert field is not None
        assert ids is not None
        assert (field.flow_px[ids == 0] == 0).all()
        now, then = (data.truth.rows(data.truth.frame == k) for k in (i, i + 1))
        for row in np.flatnonzero((now.extra["occluded"] == 0) & (then.extra["occluded"] == 0)):
            way = then.centroid_px[row] - now.centroid_px[row]
            assert np.abs(field.flow_px[ids == now.id[row]].mean(axis=0) - way).max() < 0.2
            checked += 1
    assert checked > 5


def test_the_same_reader_loads_it_as_a_motchallenge_sequence(made):
    ours, theirs = open_dataset(made), open_dataset(made, "mot")
    assert (theirs.layout, len(theirs), theirs.fps, theirs.size) == ("mot", 6, 30, SIZE)
    assert all((a.image == b.image).all() for a, b in zip(ours.frames(), theirs.frames(), strict=True))
    whole = ours.truth.rows(ours.truth.extra["occluded"] == 0)
    index = {(f, i): k for k, (f, i) in enumerate(zip(theirs.truth.frame, theirs.truth.id, strict=True))}
    rows = [index[f, i] for f, i in zip(whole.frame, whole.id, strict=True)]
    assert rows
    assert np.abs(theirs.truth.box_px[rows] - whole.box_px).max() < 2e-3


def test_dropped_frames_repeat_and_their_truth_goes_on(tmp_path):
    (tmp_path / "drop.toml").write_text("extend = 'single-rod'\n[sensor]\ndropped = 0.5\n")
    recipe = read_recipe(str(tmp_path / "drop.toml")).with_video(frames=8, size=SIZE)
    synthesise(recipe, tmp_path / "set", seed=1)
    data = open_dataset(tmp_path / "set")
    images = [frame.image for frame in data.frames()]
    dropped = data.truth.extra["dropped"] == 1
    assert 0 < dropped.sum() < 8
    for i in range(1, 8):
        assert (images[i] == images[i - 1]).all() == dropped[i]
    assert (np.diff(data.truth.position_m, axis=0) != 0).any(axis=1).all()


def test_a_lens_bends_picture_and_truth_alike(tmp_path):
    text = "extend = 'single-rod'\n[camera]\nlens = 'brown5'\ndistortion = [-0.4, 0.1, 0, 0, 0]\n"
    text += "[things.rod]\nlength_mm = 200\nwidth_mm = 30\n[sensor]\nvignetting = 0\n"
    (tmp_path / "lens.toml").write_text(text)
    recipe = read_recipe(str(tmp_path / "lens.toml")).with_video(frames=2, size=(160, 120))
    synthesise(recipe, tmp_path / "set", seed=2)
    data = open_dataset(tmp_path / "set")
    assert data.camera is not None
    assert data.camera.model == "brown5"
    image, ids = data.frame(0).image.astype(int), data.masks(0)
    assert ids is not None
    # Red is what the mask says is the rod, border pixels left out.
    inside = cv2.erode((ids == 1).astype(np.uint8), np.ones((3, 3))) > 0
    outside = cv2.dilate((ids == 1).astype(np.uint8), np.ones((5, 5))) == 0
    redness = image[..., 2] - image[..., 1]
    assert inside.sum() > 200
    assert redness[inside].mean() > redness[outside].mean() + 60


def test_what_is_in_the_way_is_never_overwritten(made, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("do not touch")
    with pytest.raises(UnwritableOutput, match="something else"):
        synthesise(small(), tmp_path / "mine", seed=4)
    with pytest.raises(UnwritableOutput, match="something else"):
        synthesise(small(), made, seed=5)
    assert [p.name for p in tmp_path.iterdir()] == ["mine"]


@pytest.mark.parametrize("options", [{"seed": -1}, {"workers": 0}, {"severity": 2.0}])
def test_impossible_options_are_refused(tmp_path, options):
    with pytest.raises(BadParameter):
        synthesise(small(), tmp_path / "set", **options)
    with pytest.raises(BadParameter, match="views"):
        synthesise(read_recipe("calibration"), tmp_path / "set")
