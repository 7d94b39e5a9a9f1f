"""Running a sweep: what is known is not measured again, what measures time runs alone."""

from collections.abc import Callable, Iterator, Sequence

from vision_robot.errors import BadParameter, MissingPackage, NoScheduler
from vision_robot.evaluate.sweep.cell import Cell, Outcome, measure
from vision_robot.evaluate.sweep.store import Store

__all__ = ["run_sweep"]

Progress = Callable[[int, int], None]

PATIENCE_S = 10
"""How long a scheduler may take to answer."""


def silence(_done: int, _total: int) -> None:
    """Progress that nobody watches."""


def run_sweep(
    cells: Sequence[Cell],
    store: Store,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress = silence,
) -> list[Outcome]:
    """Outcomes of all cells, in their order; those found in `store` are not measured again.

    Cells run in `workers` processes (joblib), or on the Dask cluster whose `scheduler` is named
    (``tcp://host:port``). Cells that must be alone follow, one after the other, in this process's
    machine, when nothing else runs. Each outcome is kept as soon as it is there, so that an interrupted
    sweep loses only what was under way. Raises NoScheduler where no cluster answers.
    """
    if workers < 1:
        raise BadParameter("workers", workers, "a whole number from 1 on")
    wanted = {cell.key: cell for cell in cells}
    known = {key: found for key, cell in wanted.items() if (found := store.find(cell))}
    missing = [cell for key, cell in wanted.items() if key not in known]
    together = [cell for cell in missing if not cell.alone]
    progress(len(known), len(wanted))
    for batch in (
        _on_cluster(together, scheduler) if scheduler else _in_processes(together, workers),
        _in_processes([cell for cell in missing if cell.alone], 1),
    ):
        for outcome in batch:
            store.keep(outcome)
            known[outcome.cell.key] = outcome
            progress(len(known), len(wanted))
    return [known[cell.key] for cell in cells]


def _in_processes(cells: Sequence[Cell], workers: int) -> Iterator[Outcome]:
    if workers == 1 or len(cells) < 2:
        yield from map(measure, cells)
        return
    from joblib import Parallel, delayed

    run = Parallel(n_jobs=workers, backend="loky", return_as="generator_unordered")
    for outcome in run(delayed(measure)(cell) for cell in cells):
        assert isinstance(outcome, Outcome), "measure returns nothing else"
        yield outcome


def _on_cluster(cells: Sequence[Cell], scheduler: str) -> Iterator[Outcome]:
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
        futures = client.map(measure, cells, key=[f"vr-{cell.key}" for cell in cells], retries=3)
        for future in as_completed(futures):
            yield future.result()
            future.release()
