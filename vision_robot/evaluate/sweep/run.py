"""Running a sweep: what is known is not measured again, what measures time runs alone."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from queue import SimpleQueue

import numpy as np

from vision_robot.errors import BadParameter, MissingPackage, NoScheduler
from vision_robot.evaluate.sweep.apart import Apart, measure_apart
from vision_robot.evaluate.sweep.cell import Cell, Outcome, measure
from vision_robot.evaluate.sweep.store import Store

__all__ = ["run_sweep"]

Progress = Callable[[int, int], None]

PATIENCE_S = 10
"""How long a scheduler may take to answer."""


def ignore(_outcome: Outcome) -> None:
    """What nobody asks for."""


def silence(_done: int, _total: int) -> None:
    """Progress that nobody watches."""


def run_sweep(
    cells: Sequence[Cell],
    store: Store,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    patience_s: float | None = None,
    progress: Progress = silence,
    done: Callable[[Outcome], None] = ignore,
) -> list[Outcome]:
    """Outcomes of all cells, in their order; those found in `store` are not measured again.

    Cells run in `workers` processes (joblib), or on the Dask cluster whose `scheduler` is named
    (``tcp://host:port``). Cells that must be alone follow, one after the other, on this machine, when
    nothing else runs. A cell that takes longer than `patience_s` or ends its process has failed; without
    patience and with one worker all is measured in this very process. Each outcome is kept as soon as it is
    there and then handed to `done`, so that an interrupted sweep loses only what was under way. The cells'
    `workspace` lies beside the outcomes. Raises NoScheduler where no cluster answers, and what
    `measure` raises.
    """
    workspace = store.workspace
    if workers < 1:
        raise BadParameter("workers", workers, "a whole number from 1 on")
    if patience_s is not None and not patience_s > 0:
        raise BadParameter("time limit", patience_s, "a positive number of seconds")
    wanted = {cell.key: cell for cell in cells}
    known = {key: found for key, cell in wanted.items() if (found := store.find(cell))}
    missing = [cell for key, cell in wanted.items() if key not in known]
    together = [cell for cell in missing if not cell.alone]
    progress(len(known), len(wanted))
    alone = _in_processes([cell for cell in missing if cell.alone], 1, workspace, patience_s, one_thread=True)
    if scheduler:
        parallel = _on_cluster(together, scheduler, workspace, patience_s)
    else:
        parallel = _in_processes(together, workers, workspace, patience_s)
    for batch in (parallel, alone):
        for outcome in batch:
            store.keep(outcome)
            known[outcome.cell.key] = outcome
            done(outcome)
            progress(len(known), len(wanted))
    return [known[cell.key] for cell in cells]


def _in_processes(
    cells: Sequence[Cell],
    workers: int,
    workspace: Path,
    patience_s: float | None,
    *,
    one_thread: bool = False,
) -> Iterator[Outcome]:
    if not cells:
        return
    if workers == 1 and patience_s is None:
        yield from (measure(cell, workspace) for cell in cells)
        return
    from joblib import Parallel, delayed

    # Threads that wait, each on a process of its own, which may crash or be ended without loss to the others.
    kept: SimpleQueue[Apart] = SimpleQueue()
    limit_s = np.inf if patience_s is None else patience_s

    def measured(cell: Cell) -> Outcome:
        one = kept.get()
        try:
            return one.measure(cell, workspace)
        finally:
            kept.put(one)

    with ExitStack() as ending:
        for _ in range(workers):
            kept.put(ending.enter_context(Apart(limit_s, one_thread=one_thread or workers > 1)))
        run = Parallel(n_jobs=workers, backend="threading", return_as="generator_unordered")
        for outcome in run(delayed(measured)(cell) for cell in cells):
            assert isinstance(outcome, Outcome), "measured returns nothing else"
            yield outcome


def _on_cluster(
    cells: Sequence[Cell], scheduler: str, workspace: Path, patience_s: float | None
) -> Iterator[Outcome]:
    if not cells:
        return
    try:
        from distributed import Client, as_completed
    except ImportError as error:
        raise MissingPackage("distributed", "--scheduler") from error
    try:
        client = Client(scheduler, timeout=PATIENCE_S)
    except (OSError, ValueError) as error:
        raise NoScheduler(scheduler, str(error)) from error
    with client:
        # Pure: a cell lost with its worker is measured anew by another, and counted once.
        keys = [f"vr-{cell.key}" for cell in cells]
        limit_s = np.inf if patience_s is None else patience_s
        futures = client.map(
            measure_apart, cells, workspace=workspace.absolute(), patience_s=limit_s, key=keys, retries=3
        )
        for future in as_completed(futures):
            yield future.result()
            future.release()
