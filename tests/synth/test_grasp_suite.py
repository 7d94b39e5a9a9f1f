"""Suite `grasp`: every fault in its own unit, every loop on the same seeds, one cell a pure function."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.evaluate.dial import dials_of
from vision_robot.evaluate.sweep.cell import Cell, measure
from vision_robot_synth.suites import Plan, suite_named
from vision_robot_synth.suites.grasp import SCENES, faulty_world, grasp_figures

SUITE = suite_named("grasp")


def test_every_scene_builds_its_world_and_is_a_step_of_a_dial():
    worlds = {scene: faulty_world(faults) for scene, faults in SCENES.items()}
    assert worlds["camera-shift-mm=5"].knock.translation[:2] == pytest.approx([0.005 / 2**0.5] * 2)
    assert np.linalg.norm(worlds["camera-rotation-deg=2"].knock.rotvec()) == pytest.approx(np.radians(2))
    assert worlds["square-size-percent=1"].square_scale == pytest.approx(1.01)
    assert worlds["latency-ms=200"].latency_s == pytest.approx(0.2)
    bent = worlds["ignored-distortion=2"]
    assert bent.lens == "pinhole"
    assert bent.view.camera.distortion[0] == pytest.approx(2 * worlds["nominal"].view.camera.distortion[0])
    dials = dials_of(list(SCENES))
    assert sum(len(dial.scenes) for dial in dials) == len(SCENES) - 2


def test_trackers_are_run_where_they_matter_or_where_they_are_asked_for():
    cells = SUITE.cells(Plan(seeds=2))
    assert len({cell.key for cell in cells}) == len(cells)
    knocked = {cell.method for cell in cells if cell.scene == "camera-rotation-deg=1"}
    assert knocked == {"open", "look-move-look", "position", "image"}
    assert {cell.method for cell in cells if cell.scene == "nominal"} == set(SUITE.methods)
    asked = SUITE.cells(Plan(scenes=("latency-ms=100",), methods=("open-background",), seeds=1))
    assert [cell.method for cell in asked] == ["open-background"]


def test_a_cell_measures_an_episode_and_a_fault_costs_what_it_costs():
    measured = grasp_figures(Path(), "open", 1, {}, strip=True)
    assert str(measured.strip).startswith("data:image/jpeg")
    figures = measured.figures
    assert figures["grasp_success"] == figures["place_success"] == 1
    assert figures["position_error_mm"] < 2
    assert figures["pick_s"] > 3
    knocked = grasp_figures(Path(), "open", 1, SCENES["camera-rotation-deg=2"]).figures
    assert knocked["grasp_success"] == 0
    assert knocked["position_error_mm"] > 10


def test_what_fails_is_an_outcome_with_its_reason():
    cell = SUITE.cells(Plan(scenes=("nominal",), methods=("open",), seeds=1))[0]
    lost = measure(replace(cell, parameters={**cell.parameters, "faults": {"rain": 1.0}}), Path())
    assert isinstance(lost.cell, Cell)
    assert "rain" in str(lost.failure)
    with pytest.raises(BadParameter, match="camera-rotation-deg=1"):
        SUITE.cells(Plan(scenes=("rain=1",)))
