"""The page that `vr pick --report` writes."""

import shlex
import sys
from pathlib import Path

from vision_robot.report.page import write_page
from vision_robot.report.pick import PickStory, pick_page
from vision_robot_cli.pick_film import stills_of
from vision_robot_cli.pick_run import PickRun

__all__ = ["write_report"]

MOST_FAILURES = 6
"""Shown with pictures; the table of the page lists all."""


def write_report(run: PickRun, path: Path, seed: int) -> None:
    """The page of a run; failures, and one episode that went well, are played again for their pictures."""
    failed = [one.seed for one in run.episodes if not one.placed][:MOST_FAILURES]
    well = [one.seed for one in run.episodes if one.placed][:1]
    stills = stills_of(run.world, run.plan, failed + well)
    story = PickStory(run.plan, run.world, tuple(run.faults), tuple(run.episodes), run.budget, stills)
    write_page(pick_page(story, command=shlex.join(["vr", *sys.argv[1:]]), seed=seed), path)
