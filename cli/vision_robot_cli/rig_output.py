"""How `vr extrinsics rig` shows its result."""

import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.evaluate.rig import RigError, rig_error
from vision_robot.formats.rig import rig_object
from vision_robot_cli.output import note
from vision_robot_cli.rig_input import RigFound, RigInput

__all__ = ["as_json", "as_text", "write_report"]

POINTS = 1000


def against(found: RigFound, given: RigInput, seed: int) -> RigError | None:
    """Errors to the truth of points drawn from where the boards were held."""
    if given.truth is None:
        return None
    middles = found.fit.rig_from_board.apply(given.board.points).reshape(-1, 3)
    rng = np.random.default_rng([seed, 99])
    points = rng.uniform(middles.min(axis=0), middles.max(axis=0), (POINTS, 3))
    return rig_error(found.fit.rig, given.truth, points, max(found.fit.noise_px, 1e-3), seed=seed)


def as_json(found: RigFound, given: RigInput, seed: int) -> dict[str, Any]:
    """The object of `vr extrinsics rig --json`: a rig file with more keys."""
    import vision_robot

    fit, error = found.fit, against(found, given, seed)
    centres = fit.rig.cam_from_rig.inverse().translation
    return {
        **rig_object(fit.rig),
        "positions_mm": {name: 1000 * c for name, c in zip(fit.rig.names, centres, strict=True)},
        "sigma": {
            name: {
                "rotation_deg": np.degrees(np.sqrt(np.diag(fit.rig.pose_covariance(i))[:3])),
                "translation_mm": 1000 * np.sqrt(np.diag(fit.rig.pose_covariance(i))[3:]),
            }
            for i, name in enumerate(fit.rig.names)
        },
        "rms_px": fit.rms_px,
        "noise_px": fit.noise_px,
        "camera_rms_px": {name: fit.camera_rms_px(i) for i, name in enumerate(fit.rig.names)},
        "moments": len(fit.moments),
        "common_moments": fit.common,
        "intrinsics_refined": fit.refined,
        "board_warp_rms_m": float(np.sqrt(np.mean(np.sum(fit.warp.displacement**2, axis=1))))
        if len(fit.warp)
        else 0.0,
        "rejected": [{"image": r.image, "corner": r.corner, "reason": r.reason} for r in fit.rejected],
        "held_out": {
            "moments": found.held_out.moments,
            "rms_mm": 1000 * found.held_out.rms_m,
            "foretold_mm": 1000 * found.held_out.foretold_m,
        }
        if found.held_out
        else None,
        "truth": {
            "position_error_mm": 1000 * error.position_m,
            "rotation_error_deg": np.degrees(error.rotation),
            "points": {
                "rms_mm": 1000 * error.rms_m,
                "foretold_mm": 1000 * error.foretold_m,
                "ratio": error.ratio,
                "n": len(error.errors),
            },
        }
        if error
        else None,
        "seed": seed if given.truth else None,
        "seconds": {**given.seconds, "total": sum(given.seconds.values())},
        "version": vision_robot.__version__,
    }


def as_text(found: RigFound, given: RigInput, seed: int = 0) -> str:
    """The result for a person at a terminal."""
    fit = found.fit
    lines = [
        f"rig of {len(fit.rig)} cameras from {len(fit.views)} views at {len(fit.moments)} moments",
        f"rms {fit.rms_px:.4f} px per corner; noise {fit.noise_px:.4f} px per axis; intrinsics "
        f"{'estimated together' if fit.refined else 'held'}",
        "",
        f"{'camera':10}{'x [mm]':>11}{'y [mm]':>11}{'z [mm]':>11}{'sigma':>9}"
        f"{'turn [deg]':>12}{'sigma':>9}{'rms [px]':>10}",
    ]
    stands = fit.rig.cam_from_rig
    for i, (name, centre) in enumerate(zip(fit.rig.names, 1000 * stands.inverse().translation, strict=True)):
        sigma = np.sqrt(np.diag(fit.rig.pose_covariance(i)))
        turn = np.degrees(np.linalg.norm(stands[i].rotvec()))
        lines.append(
            f"{name[:10]:10}{centre[0]:11.3f}{centre[1]:11.3f}{centre[2]:11.3f}{1000 * sigma[3:].max():9.4f}"
            f"{turn:12.4f}{np.degrees(sigma[:3]).max():9.5f}{fit.camera_rms_px(i):10.4f}"
        )
    lines.append("")
    for i, name in enumerate(fit.rig.names):
        shared = [f"{fit.common[i, j]} with {other}" for j, other in enumerate(fit.rig.names) if j > i]
        if shared:
            lines.append(f"{name} shares {', '.join(shared)}")
    if found.held_out:
        rms, bound = 1000 * found.held_out.rms_m, 1000 * found.held_out.foretold_m
        count = found.held_out.moments
        lines.append(
            f"boards held out at {count} moments: triangulated to {rms:.4f} mm rms, foretold <= {bound:.4f}"
        )
    for r in fit.rejected:
        if r.corner is None:
            lines.append(f"left out: {r.image}: {r.reason}")
    single = sum(r.corner is not None for r in fit.rejected)
    if single:
        lines.append(f"left out: {single} single corner(s) farther off than noise explains")
    error = against(found, given, seed)
    if error:
        rms, foretold = 1000 * error.rms_m, 1000 * error.foretold_m
        places = ", ".join(f"{1000 * p:.4f}" for p in error.position_m[1:])
        lines += [
            "",
            f"to the truth: cameras {places} mm off; {len(error.errors)} triangulated points "
            f"{rms:.4f} mm rms, foretold {foretold:.4f} mm (ratio {error.ratio:.2f})",
        ]
    return "\n".join(lines)


def write_report(found: RigFound, given: RigInput, path: Path, seed: int) -> None:
    """Write --report."""
    from vision_robot.report.page import write_page
    from vision_robot.report.rig import rig_page

    page = rig_page(
        found.fit,
        held_out=found.held_out,
        board=given.board,
        against=against(found, given, seed),
        command=shlex.join(["vr", *sys.argv[1:]]),
        seed=seed if given.truth else None,
    )
    write_page(page, path)
    note(f"report written to {path}")
