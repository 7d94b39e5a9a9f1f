"""The page of a hand-eye calibration."""

from collections.abc import Sequence

import numpy as np

from vision_robot.calibrate.boards import Board
from vision_robot.calibrate.hand_eye import HandEyeResult
from vision_robot.calibrate.hand_eye.judgement import HandEyeJudgement
from vision_robot.geometry.hand_eye import HandEye
from vision_robot.report.hand_eye_figures import (
    arm_residual_bars,
    foretold_scatter,
    position_ellipses,
    predicted_scatter,
)
from vision_robot.report.hand_eye_space import cell_in_space
from vision_robot.report.hand_eye_tables import (
    budget_table,
    closed_form_table,
    link_table,
    next_table,
    rejected_table,
    transform_table,
    views_table,
)
from vision_robot.report.page import Facts, Figures, Footer, Page, Paragraph, Part, Remarks, Section
from vision_robot.report.quantity import compact
from vision_robot.report.versions import versions

__all__ = ["hand_eye_page"]


def hand_eye_page(
    result: HandEyeResult,
    judgement: HandEyeJudgement,
    *,
    board: Board | None = None,
    truth: HandEye | None = None,
    driven: Sequence[str] = (),
    command: str = "",
    seed: int | None = None,
) -> Page:
    """Everything needed to judge a hand-eye calibration, as one page.

    Args:
        result: The calibration.
        judgement: How far to believe it.
        board: The target, for its outline.
        truth: The cell that was rendered, where there was one.
        driven: What an arm that drove by itself did, step by step.
        command: Command line that makes the page again.
        seed: Seed of what was left to chance.
    """
    # Corrected links take up a part of what the truth counts to the camera: then they cannot be compared.
    truth = truth if result.geometry is None else None
    sections = [
        Section("Result", (_facts(result, judgement), Remarks(_remarks(result, judgement)))),
        Section("Where the camera sits", _place(result, truth)),
        Section("The cell", (Figures((cell_in_space(result, _outline(board)),)),)),
        Section("Residuals", (Figures((arm_residual_bars(result), predicted_scatter(result))),)),
        Section("Can it be believed", _believed(judgement)),
        Section("Where the error comes from", (budget_table(judgement.budget),)),
    ]
    links = link_table(result)
    if links is not None:
        sections.append(Section("The arm's links", (links,)))
    if judgement.next_poses:
        sections.append(Section("Where to drive next", (next_table(judgement.next_poses),)))
    if driven:
        sections.append(
            Section("How the arm drove", (Remarks(tuple(("note", f"{step}.") for step in driven)),))
        )
    views: list[Part] = [views_table(result, judgement)]
    if result.rejected:
        views.append(rejected_table(result))
    sections.append(Section("Views", tuple(views)))
    return Page(
        title="Hand-eye calibration",
        summary=_summary(result, truth),
        sections=tuple(sections),
        footer=Footer(versions=versions(), seed=seed, command=command),
    )


def _summary(result: HandEyeResult, truth: HandEye | None) -> str:
    what = (
        "A camera carried by the wrist of an arm"
        if result.setup.carries_camera
        else "A camera that stands beside an arm which carries the board"
    )
    left_out = sum(one.corner is None for one in result.rejected)
    rejected = f" ({left_out} left out)" if left_out else ""
    known = result.covariance
    text = (
        f"{what}, from {len(result.names)} views{rejected}. Its position is known to "
        f"{compact(1e3 * known.position_m, 2)} mm and its turn to "
        f"{compact(float(np.degrees(known.turn)), 2)}°, one "
        "standard deviation over all axes."
    )
    if truth is not None:
        miss = 1e3 * float(
            np.linalg.norm(result.mount_from_cam.translation - truth.mount_from_cam.translation)
        )
        text += f" It misses the truth by {compact(miss)} mm."
    return text


def _facts(result: HandEyeResult, judgement: HandEyeJudgement) -> Facts:
    known, noise = result.covariance, result.noise
    relative = 100 * noise.relative_sigma
    left_out = sum(one.corner is None for one in result.rejected)
    turn, shift = float(np.degrees(noise.noise.turn)), 1e3 * noise.noise.shift_m
    return Facts(
        (
            ("position σ", f"{compact(1e3 * known.position_m)} mm", "all three axes together"),
            ("turn σ", f"{compact(float(np.degrees(known.turn)))}°", "all three axes together"),
            ("arm's shifts", f"{compact(shift)} mm", f"noise per axis, known to {relative[1]:.0f} %"),
            ("arm's turns", f"{compact(turn)}°", f"noise per axis, known to {relative[0]:.0f} %"),
            ("corners' noise", f"{compact(result.noise_px)} px", "per axis"),
            ("held out", f"{compact(judgement.held_out.total_px)} px", "rms per corner, from the arm's pose"),
            ("at the board", f"{compact(1e3 * judgement.held_out.total_m)} mm", "the same held-out error"),
            (
                "views used",
                f"{len(result.names)} of {len(result.names) + left_out}",
                f"{sum(map(len, result.corners))} corners",
            ),
        )
    )


def _remarks(result: HandEyeResult, judgement: HandEyeJudgement) -> tuple[tuple[str, str], ...]:
    remarks = [("note", _sentence(judgement.verdict))]
    remarks += [("caution", _sentence(said)) for said in judgement.advice]
    if not judgement.advice:
        remarks.append(
            ("good", "Nothing is missing: held-out views err as foretold, and all directions are known.")
        )
    left_out = [one for one in result.rejected if one.corner is None]
    remarks += [("caution", f"Left out: {one.image}: {one.reason}.") for one in left_out[:6]]
    return tuple(remarks)


def _place(result: HandEyeResult, truth: HandEye | None) -> tuple[Part, ...]:
    figures = Figures((position_ellipses(result, truth),))
    return (transform_table(result, truth), figures, closed_form_table(result, truth))


def _believed(judgement: HandEyeJudgement) -> tuple[Part, ...]:
    parts: list[Part] = [Figures((foretold_scatter(judgement.held_out),))]
    parts += [Paragraph(f"Not answered: {name}: {why}.") for name, why in judgement.unanswered.items()]
    return tuple(parts)


def _outline(board: Board | None) -> np.ndarray | None:
    if board is None:
        return None
    (width, height), (x, y) = board.size_m, board.origin_m
    return np.array([[-x, -y, 0], [width - x, -y, 0], [width - x, height - y, 0], [-x, height - y, 0]])


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."
