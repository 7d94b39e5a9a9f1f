"""Running the suites that `vr benchmark` names."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from vision_robot import __version__
from vision_robot.errors import BadParameter
from vision_robot.evaluate.sweep import Outcome, Store, run_sweep
from vision_robot.files import check_place
from vision_robot_cli.output import note, ticking
from vision_robot_synth.suites import SUITES, Plan, Suite, suite_named
from vision_robot_synth.suites.rendered import Tidying

__all__ = ["SuiteRun", "named_programs", "run_suites"]

ALL = "all"


@dataclass(frozen=True)
class SuiteRun:
    """A suite and what came of its cells."""

    suite: Suite
    outcomes: Sequence[Outcome]


def run_suites(
    name: str,
    plan: Plan,
    folder: Path,
    *,
    workers: int,
    scheduler: str | None,
    patience_s: float,
    data: Path | None = None,
) -> list[SuiteRun]:
    """One suite, on `data` where that is given, or all in the registry's order; results kept in `folder`."""
    if name == ALL and (plan.scenes or plan.methods):
        raise BadParameter("suite", name, f"one of {', '.join(SUITES)} where --scene or --method is given")
    if name == ALL and data is not None:
        raise BadParameter("suite", name, f"one of {', '.join(SUITES)} where --data is given")
    suites = [suite_named(one, data) for one in (SUITES if name == ALL else [name])]
    check_place(folder / "results")
    store, runs = Store(folder), []
    older = store.other_versions()
    if older:
        note(f"results of version {', '.join(older)} in {folder} are not used: {__version__} measures anew")
    for suite in suites:
        cells = suite.cells(plan)
        missing = [cell for cell in cells if store.find(cell) is None]
        if len(missing) < len(cells):
            known = len(cells) - len(missing)
            note(f"{suite.name}: {known} of {len(cells)} cells are known already, in {folder}")
        asked = suite.video_of
        tidying = Tidying(store.workspace, {cell.key: asked(cell) for cell in missing} if asked else {})
        with ticking(suite.name) as tick:
            outcomes = run_sweep(
                cells,
                store,
                workers=workers,
                scheduler=scheduler,
                patience_s=patience_s,
                progress=tick,
                done=lambda outcome, tidying=tidying: tidying.done(outcome.cell.key),
            )
        runs.append(SuiteRun(suite, outcomes))
    return runs


def named_programs(told: Iterable[str]) -> dict[str, str]:
    """Command lines by name, from NAME=COMMAND. Raises BadParameter."""
    programs = {}
    for text in told:
        name, equals, command = text.partition("=")
        if not (equals and name and "{video}" in command and "{out}" in command) or ":" in name:
            raise BadParameter("--peer", text, "NAME=COMMAND, the command with the places {video} and {out}")
        programs[name] = command
    return programs
