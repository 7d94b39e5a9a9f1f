"""Suite `flow`: who answers nothing is as wrong as the motion is long; own pairs count one by one."""

import cv2
import numpy as np
import pytest

from tests.flow_scenes import Layer, affine, noise_texture, rendered
from vision_robot.dataset import FlowField, write_flow
from vision_robot.errors import BadDataset, BadParameter
from vision_robot.evaluate.peers.flow_methods import FLOW_METHODS, flow_method
from vision_robot.evaluate.sweep.cell import measure
from vision_robot_synth.suites import Plan, suite_named

SIZE = (96, 72)
SHIFT = (1.2, -0.8)


def sequence(folder, shift=SHIFT, seed=0) -> None:
    """Two frames of a textured table that moves, as Middlebury hands them out."""
    layer = Layer(noise_texture(SIZE, seed=seed), affine(shift))
    pair = rendered([layer], SIZE, noise=1.0, seed=seed)
    folder.mkdir(parents=True)
    for number, picture in ((10, pair.first), (11, pair.second)):
        cv2.imwrite(str(folder / f"frame{number}.png"), picture)
    write_flow(FlowField(pair.flow.astype(np.float32), ~pair.visible), folder / "flow10.flo")


@pytest.mark.parametrize("name", [name for name in FLOW_METHODS if name not in ("no-motion", "cv2-tvl1")])
def test_every_method_halves_the_error_of_no_answer(name, tmp_path):
    sequence(tmp_path / "a")
    suite = suite_named("flow", tmp_path)
    still, moving = (
        measure(suite.cells(Plan(methods=(method,)))[0], tmp_path) for method in ("no-motion", name)
    )
    assert still.figures["flow_epe_px"] == pytest.approx(np.hypot(*SHIFT), abs=1e-4)
    assert moving.figures["flow_epe_px"] < 0.5 * still.figures["flow_epe_px"], moving.failure
    assert moving.figures["flow_epe_moving_px"] == pytest.approx(moving.figures["flow_epe_px"])


def test_an_unknown_method_lists_the_known():
    with pytest.raises(BadParameter, match="cv2-dis-medium"):
        flow_method("raft")


def test_sequences_are_scenes_and_their_numbers_seeds(tmp_path):
    for k, name in enumerate(("Grove", "Urban", "Venus")):
        sequence(tmp_path / "other-data" / name, seed=k)
    suite = suite_named("flow", tmp_path)
    assert suite.scenes == ("other-data/Grove", "other-data/Urban", "other-data/Venus")
    made = suite.cells(Plan(methods=("vr-fast",), seeds=7))
    assert [(c.scene[-5:], c.seed, c.alone) for c in made if not c.alone] == [
        ("Grove", 0, False), ("Urban", 1, False), ("Venus", 2, False),
    ]  # fmt: skip
    assert all(c.alone for c in made if "time" in c.work)
    (chosen,) = {c.seed for c in suite.cells(Plan(scenes=("other-data/Venus",), methods=("vr-fast",)))}
    assert chosen == 2


def test_changed_data_are_measured_anew(tmp_path):
    sequence(tmp_path / "a")
    before = suite_named("flow", tmp_path).cells(Plan(methods=("vr-fast",)))[0].key
    assert suite_named("flow", tmp_path).cells(Plan(methods=("vr-fast",)))[0].key == before
    cv2.imwrite(str(tmp_path / "a" / "frame11.png"), np.zeros(SIZE[::-1], np.uint8))
    assert suite_named("flow", tmp_path).cells(Plan(methods=("vr-fast",)))[0].key != before


def test_data_without_true_flow_are_refused(tmp_path):
    sequence(tmp_path / "a")
    (tmp_path / "a" / "flow10.flo").unlink()
    with pytest.raises(BadDataset, match="no sequence in it has true flow"):
        suite_named("flow", tmp_path)
    with pytest.raises(BadDataset, match="no such folder"):
        suite_named("flow", tmp_path / "none")
    with pytest.raises(BadParameter, match="makes its own data"):
        suite_named("ik", tmp_path)


def test_rendered_pairs_have_the_motion_of_the_belt(tmp_path):
    """At a severity of 1 the belt runs 900 mm/s: 30 mm and about 20 px from one frame to the next."""
    cells = suite_named("flow").cells(Plan(scenes=("speed=1",), methods=("no-motion", "vr"), seeds=1))
    still, ours, *timed = (measure(cell, tmp_path) for cell in cells)
    assert 15 < still.figures["flow_epe_moving_px"] < 25
    assert ours.figures["flow_epe_px"] < still.figures["flow_epe_px"]
    assert all(set(one.figures) == {"latency_p50_ms", "cpu_ms"} for one in timed)
    assert len(list((tmp_path / "rendered").glob("*/dataset.json"))) == 1


def test_a_quick_plan_is_a_part_of_the_whole():
    suite = suite_named("flow")
    whole = {(c.scene, c.method, c.seed) for c in suite.cells(Plan(seeds=2))}
    quick = {(c.scene, c.method, c.seed) for c in suite.cells(Plan(seeds=2, quick=True))}
    assert quick < whole
    assert len(quick) < len(whole) / 3
