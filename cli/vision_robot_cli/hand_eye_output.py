"""How `vr extrinsics hand-eye` shows its result: text, JSON, report."""

import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.calibrate.hand_eye import HandEyeResult
from vision_robot.evaluate.hand_eye import hand_eye_error
from vision_robot.formats.hand_eye import hand_eye_object
from vision_robot.geometry import SE3
from vision_robot.geometry.hand_eye import HandEye
from vision_robot_cli.hand_eye_input import HandEyeInput
from vision_robot_cli.hand_eye_verdict import HandEyeVerdict
from vision_robot_cli.output import note

__all__ = ["as_json", "as_text", "write_report"]

AXES = ("x", "y", "z")


def as_json(verdict: HandEyeVerdict, given: HandEyeInput, seed: int) -> dict[str, Any]:
    """The object of `vr extrinsics hand-eye --json`."""
    import vision_robot

    result, judgement = verdict.result, verdict.judgement
    found, held_out = result.hand_eye, judgement.held_out
    known, noise = result.covariance, result.noise
    return {
        **hand_eye_object(found, result.geometry.chain if result.geometry else None),
        "sigma": {
            "position_mm": 1e3 * known.position_m,
            "turn_deg": np.degrees(known.turn),
            **{f"{a}_mm": 1e3 * s for a, s in zip(AXES, known.sigma[3:6], strict=True)},
            **{f"turn_{a}_deg": np.degrees(s) for a, s in zip(AXES, known.sigma[:3], strict=True)},
        },
        "interval95": {
            **{f"{a}_mm": 1e3 * s for a, s in zip(AXES, known.half_width[3:6], strict=True)},
            **{f"turn_{a}_deg": np.degrees(s) for a, s in zip(AXES, known.half_width[:3], strict=True)},
        },
        "arm_noise": {
            "turn_rad": noise.noise.turn,
            "shift_m": noise.noise.shift_m,
            "turn_relative_sigma": noise.relative_sigma[0],
            "shift_relative_sigma": noise.relative_sigma[1],
        },
        "noise_px": result.noise_px,
        "predicted_rms_px": result.rms_px,
        "held_out": {
            "rms_px": held_out.total_px,
            "rms_mm": 1e3 * held_out.total_m,
            "found_over_foretold": held_out.ratio,
        },
        "verdict": judgement.verdict,
        "dominant": judgement.budget.dominant,
        "advice": list(judgement.advice),
        "budget_mm": {
            "mount": {name: 1e3 * value for name, value in judgement.budget.mount.items()},
            "look": {name: 1e3 * value for name, value in judgement.budget.look.items()},
            "distance_mm": 1e3 * judgement.budget.distance_m,
        },
        "board_scale": {"scale": judgement.scale.scale, "sigma": judgement.scale.sigma},
        "closed_forms": {name: _posed(mount) for name, (mount, _) in result.closed_forms.items()},
        "next_poses": _next(verdict),
        "views_used": len(result.names),
        "views_rejected": [
            {"image": r.image, "reason": r.reason} for r in result.rejected if r.corner is None
        ],
        "corners_rejected": [
            {"image": r.image, "corner": r.corner, "reason": r.reason}
            for r in result.rejected
            if r.corner is not None
        ],
        "views": _views(verdict),
        "driven": given.driven,
        "unanswered": judgement.unanswered,
        "truth": _against(result, given) if given.truth else None,
        "seed": seed,
        "seconds": {**given.seconds, "total": sum(given.seconds.values())},
        "version": vision_robot.__version__,
    }


def _posed(pose: SE3) -> dict[str, Any]:
    return {"rotvec_rad": pose.rotvec(), "translation_m": pose.translation}


def _next(verdict: HandEyeVerdict) -> dict[str, Any] | None:
    poses = verdict.judgement.next_poses
    if poses is None:
        return None
    names = verdict.result.geometry.chain.joint_names if verdict.result.geometry else None
    return {
        "sigma_mm": 1e3 * poses.sigma_m,
        "joint_names": names,
        "poses": [
            {
                "words": words,
                "base_from_wrist": _posed(poses.base_from_wrist[i]),
                "joints": None if poses.joints is None else poses.joints[i],
                "alone_mm": 1e3 * poses.alone_m[i],
                "together_mm": 1e3 * poses.together_m[i],
            }
            for i, words in enumerate(poses.words)
        ],
    }


def _views(verdict: HandEyeVerdict) -> list[dict[str, Any]]:
    result, held_out = verdict.result, verdict.judgement.held_out
    rows = []
    for i, view in enumerate(result.corners):
        off = result.arm_residuals[i]
        residual = result.predicted_residuals[i]
        rows.append(
            {
                "image": view.image,
                "corners": len(view),
                "predicted_rms_px": np.sqrt(np.mean(np.sum(residual**2, axis=1))),
                "arm_off": {"turn_deg": np.degrees(off[:3]), "shift_mm": 1e3 * off[3:]},
                "held_out": {
                    "rms_px": held_out.rms_px[i],
                    "rms_mm": 1e3 * held_out.at_board_m[i],
                    "shift_mm": 1e3 * held_out.shift_m[i],
                    "foretold_shift_mm": 1e3 * held_out.foretold_shift_m[i],
                    "turn_deg": np.degrees(held_out.turn[i]),
                    "foretold_turn_deg": np.degrees(held_out.foretold_turn[i]),
                },
                "cam_from_board": _posed(result.cam_from_board[i]),
            }
        )
    return rows


def truth_of(given: HandEyeInput) -> HandEye:
    """The rendered cell as a hand-eye without error."""
    truth = given.truth
    assert truth is not None
    return HandEye(
        truth.setup, truth.camera, truth.cell.mount_from_cam, truth.cell.far_from_board, np.zeros((12, 12))
    )


def _against(result: HandEyeResult, given: HandEyeInput) -> dict[str, Any]:
    error = hand_eye_error(result.hand_eye, truth_of(given))
    true = truth_of(given)
    return {
        true.mount_name: _posed(true.mount_from_cam),
        true.far_name: _posed(true.far_from_board),
        "position_error_mm": 1e3 * error.position_m,
        "turn_error_deg": np.degrees(error.turn),
        "in_sigma": error.in_sigma,
        "chi_square_chance": error.chance,
        "closed_form_error_mm": {
            name: 1e3 * np.linalg.norm(mount.translation - true.mount_from_cam.translation)
            for name, (mount, _) in result.closed_forms.items()
        },
    }


def as_text(verdict: HandEyeVerdict, given: HandEyeInput) -> str:
    """The result for a person at a terminal."""
    result, judgement = verdict.result, verdict.judgement
    found, known = result.hand_eye, result.covariance
    error = hand_eye_error(found, truth_of(given)) if given.truth else None
    corners = sum(map(len, result.corners))
    lines = [
        f"{result.setup.name}, from {len(result.names)} views and {corners} corners",
        f"{found.mount_name}{'':9}{'value':>11}{'sigma':>10}{'95 %':>10}"
        + (f"{'error':>11}" if error else ""),
    ]
    mount = found.mount_from_cam
    rotvec = np.degrees(mount.rotvec())
    for k, name in enumerate(AXES):
        row = (1e3 * mount.translation[k], 1e3 * known.sigma[3 + k], 1e3 * known.half_width[3 + k])
        lines.append(_row(name, "mm", row, 1e3 * error.step[3 + k] if error else None, 3))
    for k, name in enumerate(AXES):
        row = (rotvec[k], float(np.degrees(known.sigma[k])), float(np.degrees(known.half_width[k])))
        lines.append(_row(f"turn {name}", "deg", row, np.degrees(error.step[k]) if error else None, 4))
    noise = result.noise
    lines += [
        "",
        f"arm's own error per axis: {1e3 * noise.noise.shift_m:.3f} mm, "
        f"{np.degrees(noise.noise.turn):.4f} deg; corners {result.noise_px:.3f} px per axis",
    ]
    if error:
        best = min(
            (float(np.linalg.norm(form.translation - truth_of(given).mount_from_cam.translation)), name)
            for name, (form, _) in result.closed_forms.items()
        )
        lines.append(
            f"error to the truth: {1e3 * error.position_m:.3f} mm, {np.degrees(error.turn):.4f} deg; "
            f"best closed form ({best[1]}) {1e3 * best[0]:.3f} mm"
        )
    lines += [f"left out: {r.image}: {r.reason}" for r in result.rejected if r.corner is None]
    lost = sum(r.corner is not None for r in result.rejected)
    if lost:
        lines.append(f"left out: {lost} single corner(s) farther off than noise explains")
    lines += ["", *(f"- {said}" for said in judgement.sentences)]
    if judgement.next_poses:
        lines.append(f"- next: {judgement.next_poses.words[0]}")
    return "\n".join(lines)


def _row(name: str, unit: str, row: tuple[float, float, float], error: float | None, digits: int) -> str:
    value, sigma, half = row
    text = f"{name:7}{unit:>5}{'':10}{value:13.{digits}f}{sigma:10.{digits}f}{half:10.{digits}f}"
    return text if error is None else f"{text}{error:11.{digits}f}"


def write_report(verdict: HandEyeVerdict, given: HandEyeInput, path: Path, seed: int) -> None:
    """Write --report."""
    from vision_robot.report.hand_eye import hand_eye_page
    from vision_robot.report.page import write_page

    page = hand_eye_page(
        verdict.result,
        verdict.judgement,
        board=given.board,
        truth=truth_of(given) if given.truth else None,
        driven=given.driven,
        command=shlex.join(["vr", *sys.argv[1:]]),
        seed=seed if given.truth else None,
    )
    write_page(page, path)
    note(f"report written to {path}")
