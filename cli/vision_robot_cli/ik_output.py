"""How `vr ik solve` shows its answer: text, JSON, CSV."""

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.files import write_text
from vision_robot_cli.ik_input import Answer
from vision_robot_cli.output import note

__all__ = ["as_json", "as_text", "write_joints"]

MOST_ROWS = 40


def as_json(answer: Answer) -> dict[str, Any]:
    """The object of `vr ik solve --json`; q in metres and radians."""
    found, chain = answer.solutions, answer.arm.chain
    rows = [
        {
            "q": found.q[k],
            "position_error_mm": 1000 * found.position_error_m[k],
            "orientation_error_deg": np.degrees(found.orientation_error_rad[k]),
            "converged": bool(found.converged[k]),
            "branch": int(found.branch[k]),
            "reason": _reason(answer, k) or None,
            **({"branches": answer.branches.of_goal(k)} if answer.branches is not None else {}),
        }
        for k in range(len(found))
    ]
    return {
        "arm": answer.arm.name,
        "task": answer.ik.task.value,
        "joints": [
            {"name": name, "unit": "m" if slides else "rad"}
            for name, slides in zip(chain.joint_names, chain.slides, strict=True)
        ],
        "solutions": rows,
        "reached": int(found.converged.sum()),
        "closed_form": answer.ik.program.closed.structure
        if answer.ik.uses_closed_form and answer.ik.program.closed
        else None,
        "engine": answer.ik.engine.name,
        "solves_per_s": len(found) / max(answer.seconds, 1e-9),
        "assumed": answer.arm.assumed,
    }


def as_text(answer: Answer) -> str:
    """The answer for a person at a terminal: mm and degrees."""
    scale, units = _people(answer)
    names = [f"{name} [{unit}]" for name, unit in zip(answer.arm.chain.joint_names, units, strict=True)]
    lines = ["  ".join([f"{'goal':<14}", *(f"{name:>13}" for name in names), " error [mm]    [deg]"])]
    for k, where in list(enumerate(answer.goals.where))[:MOST_ROWS]:
        vectors = [answer.solutions.q[k]] if answer.branches is None else answer.branches.of_goal(k)
        for q in vectors:
            numbers = "  ".join(f"{value:13.4f}" for value in q * scale)
            lines.append(f"{where:<14}  {numbers}  {_errors(answer, k)}")
        if not answer.solutions.converged[k]:
            lines.append(f"{'':<14}  not reached: {_reason(answer, k)}")
    hidden = len(answer.goals.where) - MOST_ROWS
    if hidden > 0:
        lines.append(f"... and {hidden} more: write them with -o")
    total = len(answer.solutions)
    lines.append(f"{total - answer.unreached} of {total} goals reached")
    return "\n".join(lines)


def write_joints(answer: Answer, path: Path) -> None:
    """Write --out: CSV in mm and degrees, one row a goal (or a branch with --all)."""
    scale, units = _people(answer)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    names = [f"{name}_{unit}" for name, unit in zip(answer.arm.chain.joint_names, units, strict=True)]
    table.writerow(["goal", *names, "position_error_mm", "orientation_error_deg", "converged", "reason"])
    found = answer.solutions
    for k, where in enumerate(answer.goals.where):
        several = answer.branches is not None and found.converged[k]
        vectors = answer.branches.of_goal(k) if several and answer.branches is not None else [found.q[k]]
        for q in vectors:
            joints = [f"{value:.9g}" for value in q * scale]
            errors = [
                f"{1000 * found.position_error_m[k]:.6g}",
                f"{np.degrees(found.orientation_error_rad[k]):.6g}",
            ]
            table.writerow([where, *joints, *errors, int(found.converged[k]), _reason(answer, k)])
    write_text(path, text.getvalue())
    note(f"joint values written to {path}")


def _people(answer: Answer) -> tuple[np.ndarray, list[str]]:
    slides = answer.arm.chain.slides
    return np.where(slides, 1000, 180 / np.pi), ["mm" if one else "deg" for one in slides]


def _errors(answer: Answer, k: int) -> str:
    found = answer.solutions
    return f"{1000 * found.position_error_m[k]:11.4f}  {np.degrees(found.orientation_error_rad[k]):7.4f}"


def _reason(answer: Answer, k: int) -> str:
    if answer.solutions.converged[k]:
        return ""
    told = answer.reasons[k].text if k in answer.reasons else "out of reach (as many others before it)"
    return "; ".join(part for part in (answer.hints.get(k, ""), told) if part)
