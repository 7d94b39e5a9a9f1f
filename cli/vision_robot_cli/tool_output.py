"""How `vr extrinsics tool` shows its result."""

import json
import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.extrinsics.pivot import PivotFit
from vision_robot.extrinsics.tool import ToolFit
from vision_robot.formats.pose import pose_object
from vision_robot.geometry import SE3
from vision_robot_cli.output import note, plain
from vision_robot_cli.tool_input import ToolInput

__all__ = ["as_file", "as_json", "as_text", "write_report"]


def as_file(found: ToolFit | PivotFit) -> str:
    """The file of --out: the tip, and cameras found along with it."""
    return json.dumps({"schema": "vr.tool/1", **plain(_core(found))}, indent=1) + "\n"


def _core(found: ToolFit | PivotFit) -> dict[str, Any]:
    core: dict[str, Any] = {
        "wrist_from_tool": pose_object(SE3(np.eye(3), found.tip)),
        "tip_mm": 1000 * found.tip,
        "sigma_mm": 1000 * found.sigma,
        "covariance_mm2": 1e6 * found.covariance,
    }
    if isinstance(found, ToolFit):
        core["cameras"] = [
            {
                "name": view.name,
                "placed_beforehand": view.cam_from_base is not None,
                "cam_from_base": pose_object(pose),
            }
            for view, pose in zip(found.views, found.cam_from_base, strict=True)
        ]
    else:
        core["point_in_base_mm"] = 1000 * found.point_in_base
    return core


def as_json(found: ToolFit | PivotFit, given: ToolInput, seed: int) -> dict[str, Any]:
    """The object of `vr extrinsics tool --json`."""
    import vision_robot

    told: dict[str, Any] = {**_core(found), "poses": len(given.base_from_wrist)}
    if isinstance(found, ToolFit):
        told |= {
            "rms_px": found.rms_px,
            "noise_px": found.noise_px,
            "sightings": int(np.isfinite(found.residuals[..., 0]).sum()),
            "rejected": [{"camera": name, "pose": pose + 1} for name, pose in found.rejected],
        }
    else:
        told |= {"noise_mm": 1000 * found.noise_m, "doubtful_poses": [pose + 1 for pose in found.worst]}
    error = None if given.truth is None else 1000 * (found.tip - given.truth)
    return {
        **told,
        "truth": None
        if error is None
        else {
            "error_mm": error,
            "distance_mm": np.linalg.norm(error),
            "in_sigma": error / (1000 * found.sigma),
        },
        "seed": seed if given.truth is not None else None,
        "seconds": {**given.seconds, "total": sum(given.seconds.values())},
        "version": vision_robot.__version__,
    }


def as_text(found: ToolFit | PivotFit, given: ToolInput) -> str:
    """The result for a person at a terminal."""
    lines = [
        f"{'tip on the wrist':18}{'value [mm]':>12}{'sigma':>9}"
        + (f"{'error':>10}" if given.truth is not None else "")
    ]
    for i, axis in enumerate("xyz"):
        row = f"{axis:18}{1000 * found.tip[i]:12.4f}{1000 * found.sigma[i]:9.4f}"
        lines.append(
            row + (f"{1000 * (found.tip - given.truth)[i]:10.4f}" if given.truth is not None else "")
        )
    if isinstance(found, ToolFit):
        seen = int(np.isfinite(found.residuals[..., 0]).sum())
        lines += [
            "",
            f"{seen} sightings by {len(found.views)} camera(s) at {len(given.base_from_wrist)} poses",
        ]
        lines.append(f"rms {found.rms_px:.4f} px per sighting; noise {found.noise_px:.4f} px per axis")
        lines += [
            f"left out: {name}, pose {pose + 1}: farther off than noise explains"
            for name, pose in found.rejected
        ]
    else:
        lines += ["", f"touches scatter by {1000 * found.noise_m:.4f} mm per axis"]
        lines += [f"doubtful: pose {pose + 1} lies far from the point" for pose in found.worst]
    if given.truth is not None:
        lines += ["", f"to the truth: {1000 * np.linalg.norm(found.tip - given.truth):.4f} mm"]
    return "\n".join(lines)


def write_report(found: ToolFit | PivotFit, given: ToolInput, path: Path, seed: int) -> None:
    """Write --report."""
    from vision_robot.report.page import write_page
    from vision_robot.report.tool import tool_page

    page = tool_page(
        found,
        given.base_from_wrist,
        truth=given.truth,
        command=shlex.join(["vr", *sys.argv[1:]]),
        seed=seed if given.truth is not None else None,
    )
    write_page(page, path)
    note(f"report written to {path}")
