"""Sweeps: nothing is measured twice, nothing is lost, failures are results, clusters may lose workers."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
import pytest

from tests.evaluate.sweep.work import calls
from vision_robot.errors import BadParameter, BadTable, NoScheduler, UnwritableOutput
from vision_robot.evaluate.sweep import Cell, Store, run_sweep

ROOT = Path(__file__).parents[3]


def cells(trace: Path, n: int, **parameters) -> list[Cell]:
    return [
        Cell("suite", f"scene {i}", "method", i, "tests.evaluate.sweep.work:count",
             {"folder": str(trace), "value": i, **parameters})
        for i in range(n)
    ]  # fmt: skip


@pytest.fixture
def trace(tmp_path) -> Path:
    (tmp_path / "trace").mkdir()
    return tmp_path / "trace"


@pytest.mark.parametrize("workers", [1, 2])
def test_outcomes_come_in_order_and_once(tmp_path, trace, workers):
    store, seen = Store(tmp_path / "results"), []
    wanted = cells(trace, 5)
    found = run_sweep([*wanted, wanted[0]], store, workers=workers, progress=lambda *at: seen.append(at))
    assert [outcome.figures["metric"] for outcome in found] == [0, 2, 4, 6, 8, 0]
    assert np.isnan(found[0].figures["never"])
    assert seen[0] == (0, 5)
    assert seen[-1] == (5, 5)
    again = run_sweep(wanted, Store(tmp_path / "results"), workers=workers)
    assert [outcome.figures["metric"] for outcome in again] == [0, 2, 4, 6, 8]
    assert np.isnan(again[0].figures["never"])
    assert [calls(trace, i) for i in range(5)] == [1] * 5


def test_a_failure_is_a_result_with_its_reason(tmp_path, trace):
    store = Store(tmp_path / "results")
    (found,) = run_sweep(cells(trace, 1, fail=True), store)
    assert found.failure == "ValueError: no answer for 0"
    assert found.figures == {}
    assert store.find(found.cell) == found
    (missing,) = run_sweep([Cell("s", "s", "m", 0, "vision_robot.nowhere:f")], store)
    assert "ModuleNotFoundError" in str(missing.failure)


@pytest.mark.parametrize("workers", [1, 2])
def test_what_crashes_or_hangs_is_lost_alone(tmp_path, trace, workers):
    ends = [{"end": "killed"}, {}, {"end": "left"}, {}, {"sleep_s": 60.0}, {}]
    wanted = [cells(trace, i + 1, **end)[i] for i, end in enumerate(ends)]
    found = run_sweep(wanted, Store(tmp_path / "results"), workers=workers, patience_s=2.0)
    assert [outcome.failure for outcome in found] == [
        "Crash: its process ended with signal SIGKILL: 0 is talkative",
        None,
        "Crash: its process ended with exit code 7: the last word",
        None,
        "TimeLimit: it took longer than 2 s and was ended",
        None,
    ]
    assert [outcome.figures["metric"] for outcome in found[1::2]] == [2, 6, 10]
    assert found[4].seconds < 30
    assert [calls(trace, i) for i in range(6)] == [1] * 6


@pytest.mark.parametrize("patience_s", [None, 60.0])
def test_a_full_disk_is_no_fault_of_the_method(tmp_path, trace, patience_s):
    store = Store(tmp_path / "results")
    with pytest.raises(UnwritableOutput, match="No space left"):
        run_sweep(cells(trace, 1, end="full"), store, patience_s=patience_s)
    assert list(store) == []


def test_outcomes_are_handed_on_once_they_are_kept(tmp_path, trace):
    store, seen = Store(tmp_path / "results"), []
    run_sweep(cells(trace, 1), store)
    run_sweep(cells(trace, 3), store, done=lambda one: seen.append((one.cell.seed, store.find(one.cell))))
    assert [seed for seed, _ in seen] == [1, 2]
    assert all(kept is not None for _, kept in seen)


def test_every_parameter_is_in_the_key(trace):
    one, other = cells(trace, 1), cells(trace, 1, sleep_s=0.5)
    assert one[0].key != other[0].key
    assert one[0].key == cells(trace, 1)[0].key


def test_what_cannot_be_hashed_is_refused():
    with pytest.raises(BadParameter, match="cell parameters"):
        Cell("s", "s", "m", 0, "m:f", {"array": np.zeros(3)})


def test_a_damaged_result_is_measured_again(tmp_path, trace):
    store = Store(tmp_path / "results")
    run_sweep(cells(trace, 2), store)
    damaged = next((tmp_path / "results").glob("??/*.json"))
    damaged.write_text(damaged.read_text()[:40])
    with pytest.raises(BadTable, match=damaged.name):
        list(store)
    run_sweep(cells(trace, 2), store)
    assert sorted([calls(trace, 0), calls(trace, 1)]) == [1, 2]
    assert len(list(store)) == 2


def test_a_killed_sweep_goes_on_where_it_was(tmp_path, trace):
    """Killed outright after some outcomes: the second run measures the others, and those only."""
    script = f"""
        from tests.evaluate.sweep.test_sweep import cells, Path
        from vision_robot.evaluate.sweep import Store, run_sweep
        run_sweep(cells(Path({str(trace)!r}), 8, sleep_s=0.1), Store({str(tmp_path / "results")!r}))
    """
    running = subprocess.Popen([sys.executable, "-c", textwrap.dedent(script)], cwd=ROOT)
    while len(list(tmp_path.glob("results/??/[!.]*.json"))) < 3:
        assert running.poll() is None, "it ended too early"
        time.sleep(0.01)
    os.kill(running.pid, signal.SIGKILL)
    running.wait()
    kept = {outcome.cell.seed for outcome in Store(tmp_path / "results")}
    found = run_sweep(cells(trace, 8, sleep_s=0.1), Store(tmp_path / "results"))
    assert [outcome.figures["metric"] for outcome in found] == [2 * i for i in range(8)]
    assert all(calls(trace, i) == 1 for i in kept)
    assert sum(calls(trace, i) for i in range(8)) <= 9  # at most the one under way was begun twice


def test_no_workers_and_no_scheduler_are_refused(tmp_path, trace):
    with pytest.raises(BadParameter, match="workers"):
        run_sweep([], Store(tmp_path), workers=0)
    with pytest.raises(BadParameter, match="time limit"):
        run_sweep([], Store(tmp_path), patience_s=0)
    pytest.importorskip("distributed")
    with pytest.raises(NoScheduler, match="127"):
        run_sweep(cells(trace, 1), Store(tmp_path), scheduler="tcp://127.0.0.1:9")
