"""The page of an arm: what it is, whether its kinematics hold together, where it reaches."""

from collections.abc import Sequence

import numpy as np

from vision_robot.arm.closed_form import structure_of
from vision_robot.arm.consistency import Consistency
from vision_robot.arm.model import Arm
from vision_robot.arm.workspace import Workspace
from vision_robot.errors import UnknownStructure
from vision_robot.report.page import Facts, Figures, Footer, Page, Paragraph, Part, Remarks, Section, Table
from vision_robot.report.versions import versions
from vision_robot.report.workspace_figures import workspace_figures

__all__ = ["arm_page", "arm_piece"]


def arm_page(
    arm: Arm,
    *,
    checks: Sequence[Consistency],
    found: Workspace,
    command: str = "",
    seed: int | None = None,
) -> Page:
    """Everything `vr ik check` finds out, as one page."""
    return Page(
        title=f"Arm: {arm.name}",
        summary=summary(arm, checks),
        sections=(
            Section("Joints", (_joint_table(arm), *_about(arm))),
            Section("Forward and inverse kinematics", (_facts(checks), _check_table(checks))),
            Section("Where it reaches with the tool down", (Figures(workspace_figures(found)),)),
        ),
        footer=Footer(versions(), seed, command),
    )


def arm_piece(arm: Arm, checks: Sequence[Consistency], found: Workspace) -> tuple[Part, ...]:
    """What a longer story tells of an arm: whether it gets where it is asked, and where that is."""
    return (Paragraph(summary(arm, checks)), _facts(checks), Figures(workspace_figures(found)))


def summary(arm: Arm, checks: Sequence[Consistency]) -> str:
    """One sentence: joints, kind, whether every target was reached."""
    pattern = "".join("P" if slides else "R" for slides in arm.chain.slides)
    missed = sum(check.targets - check.reached for check in checks)
    wrong = sum(check.wrong for check in checks)
    verdict = (
        "every target drawn inside the limits was reached"
        if not missed
        else f"{missed} target(s) inside the limits were missed"
    )
    return (
        f"{len(arm)} joints ({pattern}), tool {arm.tool!r} at most {1000 * arm.reach_m:.0f} mm from the "
        f"first turning axis; {verdict}, {wrong} answer(s) wrong."
    )


def _facts(checks: Sequence[Consistency]) -> Facts:
    return Facts(
        tuple(
            (
                f"{check.method}, {check.engine}",
                f"{100 * check.reached / check.targets:.3g} %",
                f"of {check.targets} targets, {check.solves_per_s:,.0f} solves a second of one core",
            )
            for check in checks
        )
    )


def _joint_table(arm: Arm) -> Table:
    rows = []
    for name, slides, (low, high) in zip(
        arm.chain.joint_names, arm.chain.slides, arm.chain.limits, strict=True
    ):
        scale, unit = (1000.0, "mm") if slides else (180 / np.pi, "deg")
        rows.append(
            (name, "slides" if slides else "turns", f"{scale * low:.1f}", f"{scale * high:.1f}", unit)
        )
    columns = ("joint", "motion", "least", "greatest", "unit")
    return Table(columns, tuple(rows), "Joints from base to tool and their limits.", frozenset({2, 3}))


def _about(arm: Arm) -> tuple[Part, ...]:
    parts: list[Part] = []
    try:
        parts.append(Paragraph(f"Closed form: {structure_of(arm.nominal or arm.chain)}."))
    except UnknownStructure as unknown:
        parts.append(Remarks((("note", str(unknown)),)))
    if arm.assumed:
        parts.append(Remarks(tuple(("caution", said) for said in arm.assumed)))
    return tuple(parts)


def _check_table(checks: Sequence[Consistency]) -> Table:
    rows = tuple(
        (
            check.method,
            check.engine,
            str(check.targets),
            str(check.reached),
            str(check.wrong),
            f"{1e6 * check.position_error_m:.2g}",
            f"{1e6 * check.orientation_error_rad:.2g}",
        )
        for check in checks
    )
    columns = ("method", "runs as", "targets", "reached", "wrong", "largest error, µm", "largest error, µrad")
    caption = (
        "Joint values drawn inside the limits, the tool brought there by forward kinematics, joint values "
        "asked for again. Reached means within 0.01 mm and 0.01° and inside the limits; wrong means called "
        "reached and not."
    )
    return Table(columns, rows, caption, frozenset({2, 3, 4, 5, 6}))
