"""A sweep on a real Dask cluster on this machine, a worker killed in the middle of it."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.evaluate.sweep.test_sweep import ROOT, cells
from tests.evaluate.sweep.work import calls
from vision_robot.evaluate.sweep import Store, run_sweep

pytest.importorskip("distributed")


def start(stack: ExitStack, *words: str) -> subprocess.Popen:
    # The workers import the work from this folder.
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = stack.enter_context(
        subprocess.Popen(
            [sys.executable, "-m", "distributed.cli." + words[0], *words[1:]],
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    )
    stack.callback(process.kill)
    return process


@pytest.fixture
def cluster(tmp_path) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """Address of a scheduler with two workers on the loopback address, and the workers."""
    file = tmp_path / "scheduler.json"
    with ExitStack() as stack:
        start(stack, "dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
              "--scheduler-file", str(file))  # fmt: skip
        workers = [
            start(stack, "dask_worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-nanny",
                  "--no-dashboard", "--local-directory", str(tmp_path / f"w{i}"))
            for i in range(2)
        ]  # fmt: skip
        yield address(file, workers), workers


def address(file: Path, workers: list[subprocess.Popen]) -> str:
    from distributed import Client

    for _ in range(600):
        if file.exists() and file.read_text().strip():
            break
        time.sleep(0.1)
    with Client(scheduler_file=str(file), timeout=60) as client:
        client.wait_for_workers(len(workers), timeout=60)
        return json.loads(file.read_text())["address"]


def test_a_worker_is_lost_and_no_outcome_is(cluster, tmp_path):
    where, workers = cluster
    trace = tmp_path / "trace"
    trace.mkdir()
    killed = []

    def lose_one(done: int, total: int) -> None:
        if done == 3 and not killed:
            workers[0].send_signal(signal.SIGKILL)
            killed.append(done)

    wanted = cells(trace, 12, sleep_s=0.2)
    found = run_sweep(wanted, Store(tmp_path / "results"), scheduler=where, progress=lose_one)
    assert killed == [3]
    assert [outcome.figures["metric"] for outcome in found] == [2 * i for i in range(12)]
    assert not any(outcome.failure for outcome in found)
    assert len(list(Store(tmp_path / "results"))) == 12
    assert all(calls(trace, i) >= 1 for i in range(12))
