"""How `vr calibrate` shows its result: text, JSON, camera file."""

import shlex
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from vision_robot.calibrate import CalibrationResult
from vision_robot.calibrate.judgement import Judgement
from vision_robot.calibrate.judgement.advice import advice
from vision_robot.calibrate.judgement.selection import Selection
from vision_robot.evaluate.projection import projection_error
from vision_robot.formats import write_known_camera
from vision_robot.geometry import Camera, KnownCamera
from vision_robot_cli.calibration_input import CalibrationInput
from vision_robot_cli.calibration_verdict import Verdict
from vision_robot_cli.output import note

__all__ = ["as_json", "as_text", "write_camera_file", "write_report"]


def as_json(verdict: Verdict, given: CalibrationInput, seed: int) -> dict[str, Any]:
    """The object of `vr calibrate --json`."""
    import vision_robot

    result = verdict.result
    seconds = {"detect": 0.0, "solve": 0.0, **given.seconds}
    return {
        "camera": asdict(result.camera),
        "rms_px": result.rms_px,
        "noise_px": result.noise_px,
        "views_used": len(result.corners),
        "views_rejected": [
            {"image": r.image, "reason": r.reason} for r in result.rejected if r.corner is None
        ],
        "corners": result.corner_count,
        "corners_rejected": [
            {"image": r.image, "corner": r.corner, "reason": r.reason}
            for r in result.rejected
            if r.corner is not None
        ],
        "sigma": result.sigma,
        "undetermined": list(result.covariance.undetermined),
        "covariance": {
            "parameters": list(result.camera.parameter_names),
            "matrix": result.covariance.intrinsics,
        },
        "views": [
            {
                "image": view.image,
                "corners": len(view),
                "rms_px": rms,
                "cam_from_board": {"rotvec_rad": rotvec, "translation_m": translation},
            }
            for view, rms, rotvec, translation in zip(
                result.corners,
                result.view_rms_px,
                result.cam_from_board.rotvec(),
                result.cam_from_board.translation,
                strict=True,
            )
        ],
        "board": given.board.description if given.board else None,
        "board_warp_rms_m": (result.warp.displacement**2).sum(axis=1).mean() ** 0.5
        if len(result.warp)
        else 0.0,
        "judgement": _judged(verdict.judgement),
        "selection": _selected(verdict.selection) if verdict.selection else None,
        "image_size_assumed": given.size_assumed,
        "truth": _against(result.camera, given.truth) if given.truth else None,
        "seed": seed if given.truth else None,
        "seconds": {**seconds, "total": sum(seconds.values())},
        "version": vision_robot.__version__,
    }


def _against(camera: Camera, truth: Camera) -> dict[str, Any]:
    plain = projection_error(camera, truth)
    turned = projection_error(camera, truth, fit_rotation=True)
    errors = {
        f"{name}_error": getattr(camera, name) - getattr(truth, name) for name in ("fx", "fy", "cx", "cy")
    }
    return {
        **errors,
        "fx_error_percent": 100 * errors["fx_error"] / truth.fx,
        "fy_error_percent": 100 * errors["fy_error"] / truth.fy,
        "projection_error_px": {"rms": plain.rms_px, "max": plain.max_px},
        "projection_error_rotation_fitted_px": {"rms": turned.rms_px, "max": turned.max_px},
        "camera": asdict(truth),
    }


def _judged(judgement: Judgement) -> dict[str, Any]:
    held_out, halves, views = judgement.held_out, judgement.halves, judgement.next_views
    drawn, budget, moved = judgement.bootstrap, judgement.error_budget, judgement.influence
    return {
        "held_out_px": {"rms": held_out.rms_px, "standard_error": held_out.standard_error_px}
        if held_out
        else None,
        "halves": {"ratio": halves.ratio, "chance": halves.chance, "honest": halves.honest}
        if halves
        else None,
        "bootstrap": {
            "ratio": drawn.typical_ratio,
            "chance": drawn.chance,
            "honest": drawn.honest,
            "sigma": dict(zip(drawn.names, drawn.sigma, strict=True)),
        }
        if drawn
        else None,
        "influence_px": dict(zip(moved.images, moved.moved_px, strict=True)) if moved else None,
        "error_budget": {
            "lines": [asdict(line) for line in budget.lines],
            "total_px": budget.total_px,
            "total_mm": budget.total_mm,
            "distance_mm": 1000 * budget.distance_m,
        }
        if budget
        else None,
        "next_views": {
            "sigma_px": views.sigma_px,
            "views": [
                {"words": words, "alone_px": alone, "together_px": together}
                for words, alone, together in zip(views.words, views.alone_px, views.together_px, strict=True)
            ],
        }
        if views
        else None,
        "unanswered": judgement.unanswered,
    }


def _selected(selection: Selection) -> dict[str, Any]:
    rows = zip(selection.settings, selection.rms_px, selection.held_out_px, selection.why, strict=True)
    return {
        "chosen": {"model": selection.chosen.model, "warp": selection.chosen.warp},
        "candidates": [
            {"model": one.model, "warp": one.warp, "rms_px": rms, "held_out_px": held_out, "why": why}
            for one, rms, held_out, why in rows
        ],
    }


def as_text(verdict: Verdict, given: CalibrationInput) -> str:
    """The result for a person at a terminal."""
    result = verdict.result
    camera, truth = result.camera, given.truth
    corners_lost = sum(r.corner is not None for r in result.rejected)
    lines = [
        f"{camera.model} camera, {camera.width} x {camera.height} px, from {len(result.corners)} views"
        f" and {result.corner_count} corners",
        f"rms {result.rms_px:.4f} px per corner; noise {result.noise_px:.4f} px per axis",
        "",
        f"{'':6}{'value':>13}{'sigma':>11}" + (f"{'truth':>13}{'error':>11}{'in sigma':>9}" if truth else ""),
    ]
    true_values = dict(zip(truth.parameter_names, truth.parameters, strict=True)) if truth else {}
    for name, value in zip(camera.parameter_names, camera.parameters, strict=True):
        sigma = result.sigma.get(name)
        if sigma is None and name == "skew":
            continue
        digits = 3 if name in ("fx", "fy", "cx", "cy") else 6
        row = f"{name:6}{value:13.{digits}f}"
        row += f"{sigma:11.{digits}f}" if sigma is not None else f"{_why(name, result):>11}"
        if name in true_values:
            error = value - true_values[name]
            row += f"{true_values[name]:13.{digits}f}{error:11.{digits}f}"
            row += f"{error / sigma:9.2f}" if sigma else ""
        lines.append(row)
    if truth:
        error = projection_error(camera, truth)
        lines += [
            "",
            f"projection error to the truth: {error.rms_px:.4f} px rms, {error.max_px:.4f} px at most",
        ]
    if given.size_assumed:
        lines += ["", f"picture size {camera.width} x {camera.height} assumed: give --image-size to be sure"]
    for r in result.rejected:
        if r.corner is None:
            lines.append(f"left out: {r.image}: {r.reason}")
    if corners_lost:
        lines.append(f"left out: {corners_lost} single corner(s) farther off than noise explains")
    lines += ["", *(f"- {said}" for said in (*verdict.judgement.sentences, *advice(result)))]
    if verdict.judgement.next_views:
        lines.append(f"- next: {verdict.judgement.next_views.words[0]}")
    return "\n".join(lines)


def _why(name: str, result: CalibrationResult) -> str:
    return "unknown" if name in result.covariance.undetermined else "fixed"


def write_report(verdict: Verdict, given: CalibrationInput, path: Path, seed: int) -> None:
    """Write --report."""
    from vision_robot.report.calibration import calibration_page
    from vision_robot.report.page import write_page

    page = calibration_page(
        verdict.result,
        board=given.board,
        truth=given.truth,
        images=given.pictures,
        judgement=verdict.judgement,
        selection=verdict.selection,
        command=shlex.join(["vr", *sys.argv[1:]]),
        seed=seed if given.truth else None,
    )
    write_page(page, path)
    note(f"report written to {path}")


def write_camera_file(result: CalibrationResult, path: Path, file_format: str | None) -> None:
    """Write --out."""
    write_known_camera(KnownCamera(result.camera, result.covariance.intrinsics), path, file_format)
    note(f"camera written to {path}")
