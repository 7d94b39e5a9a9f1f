"""Suite trackers: what a plan asks for, rendered and own videos end to end, failures with their reasons."""

import sys
import textwrap
from pathlib import Path

import cv2
import numpy as np
import pytest

from vision_robot.errors import BadDataset, BadParameter
from vision_robot.evaluate.sweep import Outcome, Store, run_sweep
from vision_robot_synth.suites import Plan, suite_named
from vision_robot_synth.suites.rendered import Tidying, rendered_set
from vision_robot_synth.suites.tracker_cells import varied

TINY = {"frames": 14, "size": (160, 120)}
OURS = ("rgb", "background")


def measured(folder: Path, plan: Plan, data: Path | None = None) -> list[Outcome]:
    return run_sweep(suite_named("trackers", data).cells(plan), Store(folder))


def own_video(folder: Path, frames: int = 30) -> Path:
    """A red square that wanders over a speckled table, in the layout of OTB."""
    rng = np.random.default_rng(0)
    table = rng.integers(90, 130, (96, 128, 3), dtype=np.uint8)
    (folder / "img").mkdir(parents=True)
    rows = []
    for k in range(frames):
        left, top = 10 + 3 * k, 40 + round(10 * np.sin(k / 4))
        image = table + rng.integers(0, 4, table.shape, dtype=np.uint8)
        image[top : top + 16, left : left + 16] = (30, 30, 210)
        cv2.imwrite(str(folder / "img" / f"{k + 1:04d}.png"), image)
        rows.append(f"{left + 1},{top + 1},16,16")
    (folder / "groundtruth_rect.txt").write_text("\n".join(rows) + "\n")
    return folder


def test_a_plan_is_every_scene_method_and_seed_once():
    plan = Plan(scenes=("noise=1", "single-rod"), methods=("rgb", "cv2-mog2"), seeds=5)
    cells = suite_named("trackers").cells(plan)
    assert len({cell.key for cell in cells}) == len(cells)
    plain = [cell for cell in cells if ":" not in cell.method and not cell.alone]
    assert {(cell.scene, cell.method, cell.seed) for cell in plain} == {
        (scene, method, seed) for scene in plan.scenes for method in plan.methods for seed in range(5)
    }
    assert len(plain) == 20
    # One film strip for each scene and method.
    assert sum(bool(cell.parameters.get("strip")) for cell in plain) == 4
    alone = [cell for cell in cells if cell.alone]
    assert {(cell.scene, cell.method, cell.seed) for cell in alone} == {
        ("noise=1", method, seed) for method in plan.methods for seed in (0, 1)
    }
    variants = {cell.method for cell in cells if ":" in cell.method}
    assert {"rgb:tolerance=6", "rgb:tolerance=24", "rgb:min_area_px=x0.5"} <= variants
    assert {"cv2-mog2:min_area_px=15", "cv2-mog2:min_area_px=60"} <= variants


def test_a_quick_plan_is_small_and_has_no_variants():
    suite = suite_named("trackers")
    cells = suite.cells(Plan(seeds=2, quick=True))
    assert len(cells) < len(suite.cells(Plan(seeds=2))) / 3
    assert not [cell for cell in cells if ":" in cell.method]
    assert {cell.method for cell in cells} > {"rgb", "rgb-plain", "cv2-mog2"}


def test_unknown_names_are_refused_with_those_there_are():
    suite = suite_named("trackers")
    with pytest.raises(BadParameter, match="near-background=0"):
        suite.cells(Plan(scenes=("rain",)))
    with pytest.raises(BadParameter, match="cv2-csrt"):
        suite.cells(Plan(methods=("yolo",)))


@pytest.mark.parametrize(
    ("option", "usual", "factor", "value"),
    [
        ("tolerance", 12.0, 0.5, 6.0),
        ("window", 25, 0.5, 13),
        ("median_px", 5, 2.0, 11),
        ("back", 1, 0.5, 1),
        ("closing_px", 7, 0.5, 4),
    ],
)
def test_variants_are_of_the_options_kind(option, usual, factor, value):
    found = varied(option, usual, factor)
    assert found == value
    assert type(found) is type(usual)


def test_rendered_videos_are_measured_and_shared(tmp_path):
    plan = Plan(scenes=("single-rod",), methods=OURS, seeds=1, quick=True, **TINY)
    found = measured(tmp_path, plan)
    assert [outcome.failure for outcome in found] == [None] * 4
    scored = {outcome.cell.method: outcome for outcome in found if not outcome.cell.alone}
    assert scored["rgb"].figures["hota"] > 0.8
    assert scored["rgb"].figures["centroid_error_mm"] < 4
    assert (scored["rgb"].strip or "").startswith("data:image/jpeg")
    timed = next(outcome.figures for outcome in found if outcome.cell.alone)
    assert set(timed) == {
        "latency_p50_ms", "latency_p99_ms", "fps", "cpu_s", "bandwidth_share", "peak_memory_mb",
        "streaming_success_auc",
    }  # fmt: skip
    assert 0 < timed["latency_p50_ms"] <= timed["latency_p99_ms"]
    assert 0 < timed["bandwidth_share"] < 1
    assert timed["streaming_success_auc"] <= scored["rgb"].figures["success_auc"] + 0.01
    assert len(list((tmp_path / "workspace" / "rendered").glob("single-rod*[!k]"))) == 1


def test_sets_are_removed_after_their_last_cell(tmp_path):
    told = {"recipe": "single-rod", "severity": 0.5, "seed": 0, "frames": 2, "size": [64, 48]}
    data = rendered_set(tmp_path, **{**told, "size": (64, 48)})
    tidying = Tidying(tmp_path, {"a": told, "b": told, "c": None})
    for key in ("a", "c", "unknown"):
        tidying.done(key)
    assert data.path.is_dir()
    tidying.done("b")
    assert not data.path.exists()


def test_own_videos_in_published_layouts(tmp_path):
    own_video(tmp_path / "mine" / "square")
    plan = Plan(methods=("rgb", "rgb-plain", "cv2-kcf", "background"), quick=True)
    found = measured(tmp_path / "out", plan, tmp_path / "mine")
    assert {outcome.cell.scene for outcome in found} == {"square"}
    assert [outcome.failure for outcome in found] == [None] * len(found)
    scored = {outcome.cell.method: outcome.figures for outcome in found if not outcome.cell.alone}
    for method in ("rgb", "rgb-plain", "background"):
        assert scored[method]["success_auc"] > 0.85, method
        assert scored[method]["centroid_error_px"] < 0.6, method
        assert np.isnan(scored[method]["centroid_error_mm"])
    with pytest.raises(BadDataset):
        suite_named("trackers", tmp_path / "nowhere")


PROGRAM = """
    import sys
    kind, video, out = sys.argv[1:]
    rows = {
        "good": [(k, 1, 17.5 + 3 * k, 48, 9.5 + 3 * k, 39.5, 16, 16) for k in range(30)],
        "empty": [(k, 1, 17.5, 48, "", "", "", "") for k in range(30)],
    }
    if kind == "bad":
        sys.exit("the program has no model")
    with open(out, "w") as file:
        print("frame,id,u_px,v_px,left_px,top_px,width_px,height_px", file=file)
        for row in rows[kind]:
            print(*row, sep=",", file=file)
"""


def test_programs_take_part_and_fail_with_their_own_words(tmp_path):
    own_video(tmp_path / "square")
    program = tmp_path / "program.py"
    program.write_text(textwrap.dedent(PROGRAM))
    told = {kind: f"{sys.executable} {program} {kind} {{video}} {{out}}" for kind in ("good", "empty", "bad")}
    plan = Plan(methods=tuple(told), programs=told, quick=True)
    good, empty, bad = measured(tmp_path / "out", plan, tmp_path / "square")
    assert good.failure is None
    assert 0.3 < good.figures["success_auc"] < 1
    assert good.figures["recall"] == 1
    # Boxes that are no numbers are no result.
    assert "without the columns that are compared" in str(empty.failure)
    assert "the program has no model" in str(bad.failure)
