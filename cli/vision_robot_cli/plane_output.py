"""How `vr extrinsics plane` shows its result."""

import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.evaluate.plane import PlaneError, plane_error
from vision_robot.formats.work_plane import plane_object
from vision_robot_cli.output import note
from vision_robot_cli.plane_input import PlaneFound, PlaneInput

FEW = 6
"""Degrees of freedom below which residuals tell the noise badly."""

__all__ = ["as_json", "as_text", "write_report"]


def as_json(found: PlaneFound, given: PlaneInput, seed: int) -> dict[str, Any]:
    """The object of `vr extrinsics plane --json`: a plane file with more keys."""
    import vision_robot

    fit = found.fit
    station_from_cam = fit.plane.cam_from_station.inverse()
    sigma = np.sqrt(np.diag(fit.plane.pose_covariance))
    return {
        **plane_object(fit.plane),
        "camera_position_mm": 1000 * station_from_cam.translation,
        "elevation_deg": np.degrees(fit.elevation),
        "sigma": {"rotation_deg": np.degrees(sigma[:3]), "translation_mm": 1000 * sigma[3:]},
        "rms_px": fit.rms_px,
        "noise_px": fit.noise_px,
        "points": sum(map(len, fit.views)),
        "degrees_of_freedom": fit.degrees_of_freedom,
        "views": [
            {
                "image": view.image,
                "points": len(view),
                "rms_px": np.sqrt(np.mean(np.sum(residual**2, axis=1))),
            }
            for view, residual in zip(fit.views, fit.residuals, strict=True)
        ],
        "elsewhere": [
            {
                "image": level.image,
                "height_mm": 1000 * level.height_m,
                "sigma_height_mm": 1000 * level.sigma_height_m,
                "tilt_deg": np.degrees(level.tilt),
                "sigma_tilt_deg": np.degrees(level.sigma_tilt),
            }
            for level in fit.levels
        ],
        "mirrored_tilt_sigma": fit.rival_gap,
        "rejected": [
            {"image": r.image, "point": r.corner, "reason": r.reason}
            for r in (*given.rejected, *fit.rejected)
        ],
        "held_out": {
            "rms_mm": 1000 * found.held_out.rms_m,
            "foretold_mm": 1000 * found.held_out.foretold_m,
            "ratio": found.held_out.ratio,
        }
        if found.held_out
        else None,
        "truth": _against(given.truth and plane_error(fit.plane, given.truth)),
        "seed": seed if given.truth else None,
        "seconds": {**given.seconds, "total": sum(given.seconds.values())},
        "version": vision_robot.__version__,
    }


def _against(error: PlaneError | None) -> dict[str, Any] | None:
    if error is None:
        return None
    return {
        "position_error_mm": 1000 * error.camera_position_m,
        "rotation_error_deg": np.degrees(error.rotation),
        "chi_square": error.chi_square,
        "points": {"rms_mm": 1000 * error.rms_m, "foretold_mm": 1000 * error.foretold_m, "n": error.points},
    }


def as_text(found: PlaneFound, given: PlaneInput) -> str:
    """The result for a person at a terminal."""
    fit = found.fit
    x, y, z = 1000 * fit.plane.cam_from_station.inverse().translation
    sigma = np.sqrt(np.diag(fit.plane.pose_covariance))
    shift, turn = 1000 * sigma[3:].max(), np.degrees(sigma[:3]).max()
    middle = fit.plane.pixels(np.concatenate(fit.points)[:, :2].mean(axis=0)[None])
    own = 1000 * np.sqrt(np.diag(fit.plane.measure(middle, fit.noise_px)[1][0]))
    lines = [
        f"work plane from {sum(map(len, fit.views))} points in {len(fit.views)} view(s)",
        f"rms {fit.rms_px:.4f} px per point; noise {fit.noise_px:.4f} px per axis",
        "",
        f"camera at ({x:.2f}, {y:.2f}, {z:.2f}) mm in {{S}}, {np.degrees(fit.elevation):.1f} deg above it",
        f"sigma of its pose: at most {shift:.4f} mm and {turn:.4f} degrees along any axis",
        f"sigma of a point at the middle seen with that noise: {own[0]:.4f} mm in x, {own[1]:.4f} mm in y",
    ]
    if found.held_out:
        rms, foretold = 1000 * found.held_out.rms_m, 1000 * found.held_out.foretold_m
        lines.append(f"points held out: {rms:.4f} mm rms, foretold {foretold:.4f} mm")
    for level in fit.levels:
        height, spread = 1000 * level.height_m, 1000 * level.sigma_height_m
        lines.append(f"{level.image}: elsewhere, {height:+.3f} +- {spread:.3f} mm over the first one's plane")
    if np.isfinite(fit.rival_gap):
        lines.append(f"the mirrored tilt explains the first view {fit.rival_gap:.0f} sigma less well")
    lines += [
        f"left out: {r.image}{'' if r.corner is None else f' point {r.corner}'}: {r.reason}"
        for r in (*given.rejected, *fit.rejected)
    ]
    if fit.degrees_of_freedom < FEW:
        lines.append("- so few points hardly tell their own noise: give --sigma-px")
    if given.truth:
        error = plane_error(fit.plane, given.truth)
        lines += [
            "",
            f"to the truth: camera {1000 * error.camera_position_m:.3f} mm, "
            f"{np.degrees(error.rotation):.4f} degrees off; {error.points} points of the table "
            f"{1000 * error.rms_m:.4f} mm rms, foretold {1000 * error.foretold_m:.4f} mm",
        ]
    return "\n".join(lines)


def write_report(found: PlaneFound, given: PlaneInput, path: Path, seed: int) -> None:
    """Write --report."""
    from vision_robot.report.page import write_page
    from vision_robot.report.plane import plane_page

    page = plane_page(
        found.fit,
        held_out=found.held_out,
        board=given.board,
        truth=given.truth,
        images=given.pictures,
        command=shlex.join(["vr", *sys.argv[1:]]),
        seed=seed if given.truth else None,
    )
    write_page(page, path)
    note(f"report written to {path}")
