"""The page of a calibration."""

from collections.abc import Mapping

import numpy as np

from vision_robot.calibrate.boards import Board
from vision_robot.calibrate.judgement import Judgement
from vision_robot.calibrate.judgement.selection import Selection
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.geometry import Camera
from vision_robot.report.calibration_advice import remarks
from vision_robot.report.calibration_findings import AgainstTruth, Findings, find
from vision_robot.report.calibration_tables import parameter_table, rejection_table, view_table
from vision_robot.report.judgement_sections import judgement_sections, selection_section
from vision_robot.report.lens_figures import lens_figures, truth_maps, uncertainty_maps
from vision_robot.report.page import Facts, Figures, Footer, Gallery, Page, Paragraph, Part, Remarks, Section
from vision_robot.report.quantity import compact, with_sigma
from vision_robot.report.residual_figures import (
    residual_histogram,
    residual_map,
    residual_scatter,
    view_errors,
)
from vision_robot.report.thumbnails import thumbnails
from vision_robot.report.versions import versions
from vision_robot.report.view_figures import board_poses, coverage
from vision_robot.types import Array, Float, Image

__all__ = ["calibration_page", "calibration_piece"]


def calibration_page(
    result: CalibrationResult,
    *,
    board: Board | None = None,
    truth: Camera | None = None,
    images: Mapping[str, Image] | None = None,
    judgement: Judgement | None = None,
    selection: Selection | None = None,
    title: str = "Camera calibration",
    command: str = "",
    seed: int | None = None,
) -> Page:
    """Everything needed to judge a calibration, as one page.

    Args:
        result: The calibration.
        board: The target, for its outline and its description.
        truth: The camera that made the pictures, where it is known.
        images: Pictures by the names in `result.corners`; small copies are shown.
        judgement: How far to believe it; shown where given.
        selection: The choice of model; shown where given.
        title: Title of the page.
        command: Command line that makes the page again.
        seed: Seed of what was left to chance.

    Raises:
        BadParameter: The truth has another picture size.
    """
    findings = find(result, truth)
    sections = [
        Section("Result", (_facts(findings), Remarks(remarks(findings)))),
        Section("Parameters", (parameter_table(findings), *_about_parameters(findings))),
        Section(
            "Residuals",
            (
                Figures(
                    (
                        residual_map(findings),
                        residual_scatter(findings),
                        view_errors(findings),
                        residual_histogram(findings),
                    )
                ),
            ),
        ),
        Section(
            "Projection uncertainty",
            (Figures(uncertainty_maps(findings)), Paragraph(ABOUT_UNCERTAINTY)),
        ),
    ]
    if judgement is not None:
        sections += judgement_sections(judgement, result.camera)
    if selection is not None:
        sections.append(selection_section(selection))
    if findings.truth is not None:
        sections.append(Section("Against the truth", _against(findings, findings.truth)))
    if any(result.camera.lens.coefficient_names):
        sections.append(Section("Lens", (Figures(lens_figures(findings)),)))
    sections.append(Section("Views", _views(findings, board, images or {})))
    return Page(
        title=title,
        summary=_summary(findings, board),
        sections=tuple(sections),
        footer=Footer(versions=versions(), seed=seed, command=command),
    )


MOST_IN_A_PIECE = 8
"""Pictures shown where the calibration is a part of a longer story."""


def calibration_piece(
    result: CalibrationResult, truth: Camera, images: Mapping[str, Image]
) -> tuple[Part, ...]:
    """What a longer story tells of a calibration: pictures, headline figures, and the error to the truth."""
    findings = find(result, truth)
    assert findings.truth is not None, "the truth was given"
    shown = dict(list(images.items())[:MOST_IN_A_PIECE])
    return (
        Gallery(thumbnails(findings, shown)),
        _facts(findings),
        *_against(findings, findings.truth),
    )


ABOUT_UNCERTAINTY = (
    "The maps carry the covariance of the intrinsics into pixels. The camera's own frame is known no better "
    "than its "
    "intrinsics, so the small motion of that frame which the corners cannot tell from a change of intrinsics "
    "is taken "
    "out first. The noise of the corners is in these numbers; a wrong lens model or a bent board is not."
)


def _summary(findings: Findings, board: Board | None) -> str:
    result = findings.result
    camera = result.camera
    target = f" on a {board.description}" if board else ""
    left_out = sum(one.corner is None for one in result.rejected)
    rejected = f" ({left_out} left out)" if left_out else ""
    truth = ""
    if findings.truth:
        miss = compact(findings.truth.same_ray.rms_px)
        truth = f" It misses the truth by {miss} px rms over the whole picture."
    return (
        f"A {camera.width} × {camera.height} px camera with the {camera.model} lens model, calibrated from "
        f"{result.corner_count} corners in {len(result.corners)} views{rejected}{target}. "
        f"The residuals are {compact(result.rms_px)} px rms per point.{truth}"
    )


def _facts(findings: Findings) -> Facts:
    result = findings.result
    values = dict(zip(result.camera.parameter_names, result.camera.parameters, strict=True))
    about = {
        "fx": "focal length along u",
        "fy": "focal length along v",
        "cx": "principal point, u",
        "cy": "principal point, v",
    }
    items = []
    for name, text in about.items():
        value, sigma = with_sigma(values[name], result.sigma.get(name, 0.0))
        known = name in result.sigma
        items.append(
            (name, f"{value} ± {sigma} px" if known else f"{value} px", text if known else f"{text}, fixed")
        )
    left_out = sum(one.corner is None for one in result.rejected)
    lost = sum(one.corner is not None for one in result.rejected)
    items += [
        ("rms residual", f"{compact(result.rms_px)} px", "per point, both axes together"),
        ("noise σ", f"{compact(result.noise_px)} px", "per corner and axis"),
        (
            "views used",
            f"{len(result.corners)} of {len(result.corners) + left_out}",
            f"{result.corner_count} corners, {lost} left out" if lost else f"{result.corner_count} corners",
        ),
        (
            "expected projection error",
            f"{compact(findings.expected_error.expected_px, 2)} px",
            f"rms over the picture; {compact(findings.expected_error.low_px, 2)} to "
            f"{compact(findings.expected_error.high_px, 2)} px in 95 %",
        ),
    ]
    return Facts(tuple(items))


def _about_parameters(findings: Findings) -> tuple[Part, ...]:
    result = findings.result
    parts: list[Part] = []
    if len(result.warp):
        bend = 1000 * np.linalg.norm(result.warp.displacement, axis=1)
        parts.append(
            Paragraph(
                f"The board's shape was estimated too ({len(result.warp)} numbers): it departs from its "
                "drawing by "
                f"{compact(float(np.sqrt(np.mean(bend**2))), 2)} mm rms, {compact(float(bend.max()), 2)} mm "
                "at most."
            )
        )
    return tuple(parts)


def _against(findings: Findings, truth: AgainstTruth) -> tuple[Part, ...]:
    found, expected = truth.rotation_fitted.rms_px, findings.expected_error
    inside = expected.low_px <= found <= expected.high_px
    return (
        Figures(truth_maps(findings, truth)),
        Paragraph(
            f"With the rotation taken out the error is {compact(found)} px rms. The stated uncertainty "
            "foretells "
            f"{compact(expected.expected_px)} px, and {compact(expected.low_px, 2)} to "
            f"{compact(expected.high_px, 2)} px "
            f"in 95 of 100 calibrations like this one: it lies {'inside' if inside else 'outside'}."
        ),
    )


def _views(findings: Findings, board: Board | None, images: Mapping[str, Image]) -> tuple[Part, ...]:
    result = findings.result
    parts: list[Part] = [
        Figures((coverage(findings), board_poses(findings, _outline(board)))),
        view_table(findings),
    ]
    if result.rejected:
        parts.append(rejection_table(result))
    pictures = thumbnails(findings, images)
    if pictures:
        parts.append(Gallery(pictures))
    return tuple(parts)


def _outline(board: Board | None) -> Float[Array, "4 3"] | None:
    """Edge of the printed target in the board frame [m], from point 0's corner round."""
    if board is None:
        return None
    (width, height), (x, y) = board.size_m, board.origin_m
    return np.array([[-x, -y, 0], [width - x, -y, 0], [width - x, height - y, 0], [-x, height - y, 0]])
