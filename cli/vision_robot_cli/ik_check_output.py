"""How `vr ik check` shows what it found."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from vision_robot.arm import Arm
from vision_robot.arm.closed_form import structure_of
from vision_robot.arm.consistency import Consistency
from vision_robot.arm.workspace import Slice, Workspace
from vision_robot.errors import UnknownStructure

__all__ = ["as_json", "as_text"]


def as_json(arm: Arm, checks: Sequence[Consistency], found: Workspace, seed: int) -> dict[str, Any]:
    """The object of `vr ik check --json`; lengths in metres, angles in radians."""
    closed, why = _closed_form(arm)
    chain = arm.chain
    return {
        "arm": arm.name,
        "base": arm.base,
        "tool": arm.tool,
        "reach_m": arm.reach_m,
        "joints": [
            {"name": name, "slides": bool(slides), "least": low, "greatest": high}
            for name, slides, (low, high) in zip(chain.joint_names, chain.slides, chain.limits, strict=True)
        ],
        "closed_form": closed,
        "closed_form_refused": why,
        "assumed": arm.assumed,
        "checks": checks,
        "workspace": {
            "height_m": found.height_m,
            "area_m2": _area(found.level),
            "nearest_m": _radii(found.level)[0],
            "farthest_m": _radii(found.level)[1],
            "best_manipulability": float(np.nanmax(found.level.manipulability, initial=0.0)),
        },
        "seed": seed,
    }


def as_text(arm: Arm, checks: Sequence[Consistency], found: Workspace) -> str:
    """What was found, for a person at a terminal."""
    closed, why = _closed_form(arm)
    lines = [f"{arm.name}: base {arm.base}, tool {arm.tool}, reach {1000 * arm.reach_m:.0f} mm"]
    for name, slides, (low, high) in zip(
        arm.chain.joint_names, arm.chain.slides, arm.chain.limits, strict=True
    ):
        scale, unit = (1000.0, "mm") if slides else (180 / np.pi, "deg")
        lines.append(
            f"  {name:<22} {'slides' if slides else 'turns '} {scale * low:9.1f} .. {scale * high:.1f} {unit}"
        )
    lines.append(f"closed form: {closed or why}")
    for check in checks:
        lines += [
            f"{check.method}, {check.engine}: {check.reached} of {check.targets} targets reached, "
            f"{check.wrong} wrong, {check.solves_per_s:,.0f} solves a second of one core",
            f"  at most {1e6 * check.position_error_m:.2g} um and "
            f"{1e6 * check.orientation_error_rad:.2g} urad off",
        ]
    if found.level.reached.any():
        nearest, farthest = (1000 * radius for radius in _radii(found.level))
        lines.append(
            f"tool down, {1000 * found.height_m:.0f} mm above the base: {_area(found.level):.3f} m2 in "
            "reach, "
            f"{nearest:.0f} to {farthest:.0f} mm from the base's axis"
        )
    else:
        lines.append("no place can be reached with the tool pointing down and its x outwards")
    return "\n".join(lines)


def _closed_form(arm: Arm) -> tuple[str | None, str | None]:
    try:
        return structure_of(arm.nominal or arm.chain), None
    except UnknownStructure as unknown:
        return None, str(unknown)


def _area(part: Slice) -> float:
    cell = float(np.prod([np.diff(axis[:2])[0] for axis in (part.across_m, part.up_m)]))
    return cell * int(part.reached.sum())


def _radii(part: Slice) -> tuple[float, float]:
    x, y = np.meshgrid(part.across_m, part.up_m)
    radii = np.hypot(x, y)[part.reached]
    return float(np.min(radii, initial=np.inf)), float(np.max(radii, initial=0.0))
