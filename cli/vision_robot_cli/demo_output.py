"""How `vr demo` shows what happened: page, JSON and text."""

import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.evaluate.plane import plane_error
from vision_robot.evaluate.projection import projection_error
from vision_robot.pick.summary import summary_of
from vision_robot.report.demo import demo_page
from vision_robot.report.page import write_page
from vision_robot_cli import calibration_output
from vision_robot_cli.demo_run import Demo

__all__ = ["as_json", "as_text", "write_report"]

SHOWN = ("centroid_error_px", "centroid_error_mm", "yaw_error_deg", "recall", "ms_per_frame")


def write_report(done: Demo, path: Path, seed: int) -> None:
    """The one page."""
    write_page(demo_page(done.story, command=shlex.join(["vr", *sys.argv[1:]]), seed=seed), path)


def as_json(done: Demo, out: Path, seed: int) -> dict[str, Any]:
    """The object of `vr demo --json`."""
    story = done.story
    return {
        "calibration": calibration_output.as_json(done.verdict, done.given, seed),
        "plane": {"error_mm": _plane_error_mm(done), "rms_px": story.plane.rms_px},
        "tracking": {
            name: {figure: answer.figures[figure] for figure in SHOWN}
            for name, answer in story.answers.items()
        },
        "ik": [
            {
                "method": check.method,
                "ik_success": check.reached / check.targets,
                "solves_per_s": check.solves_per_s,
            }
            for check in story.checks
        ],
        "pick": {name: _pick(done, name) for name in story.picks},
        "seconds": {**story.seconds, "total": sum(story.seconds.values())},
        "out": out,
    }


def _pick(done: Demo, name: str) -> dict[str, Any]:
    found = summary_of(done.story.picks[name].episodes)
    return {
        "episodes": found.episodes,
        "grasp_success": found.reached_rung["lifted"] / found.episodes,
        "place_success": found.reached_rung["placed"] / found.episodes,
        "position_error_mm": {"median": 1000 * found.position_m.median, "p95": 1000 * found.position_m.p95},
        "yaw_error_deg": {
            "median": float(np.degrees(found.yaw_rad.median)),
            "p95": float(np.degrees(found.yaw_rad.p95)),
        },
    }


def _plane_error_mm(done: Demo) -> float:
    return 1000 * plane_error(done.story.plane.plane, done.story.world.truth.plane).rms_m


def as_text(done: Demo) -> str:
    """A line for each chapter."""
    story = done.story
    off = projection_error(story.camera.camera, story.world.view.camera)
    lines = [
        f"camera: {len(story.camera.corners)} views, {off.rms_px:.3f} px rms off the truth",
        f"table:  positions on it {_plane_error_mm(done):.3f} mm rms off the truth",
    ]
    for name, answer in story.answers.items():
        px, mm, ms = (
            answer.figures[one] for one in ("centroid_error_px", "centroid_error_mm", "ms_per_frame")
        )
        lines.append(f"track:  {name:<13} {px:.2f} px, {mm:.2f} mm off, {ms:.1f} ms a frame")
    for check in story.checks:
        lines.append(
            f"arm:    {check.method:<13} {check.reached} of {check.targets} targets, "
            f"{check.solves_per_s:,.0f} solves a second"
        )
    for name, one in story.picks.items():
        found = summary_of(one.episodes)
        lines.append(
            f"pick:   {name}: {found.reached_rung['placed']} of {found.episodes} placed, "
            f"{1000 * found.position_m.median:.2f} mm off at closing (median)"
        )
    lines.append(f"in {sum(story.seconds.values()):.0f} s")
    return "\n".join(lines)
