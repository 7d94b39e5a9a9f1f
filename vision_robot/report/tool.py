"""The page of a tool's tip."""

import numpy as np

from vision_robot.extrinsics.pivot import PivotFit
from vision_robot.extrinsics.tool import ToolFit
from vision_robot.extrinsics.tool_checks import axis_in_words, turning_axis
from vision_robot.geometry import SE3
from vision_robot.report.ellipse_figure import ellipses
from vision_robot.report.page import Facts, Figure, Figures, Footer, Page, Remarks, Section, Table
from vision_robot.report.pixel_figures import residual_arrows, scatter_rings
from vision_robot.report.quantity import compact, signed, with_sigma
from vision_robot.report.space_figure import InSpace, space_figure
from vision_robot.report.versions import versions
from vision_robot.types import Array, Float

__all__ = ["tool_page"]


def tool_page(
    fit: ToolFit | PivotFit,
    base_from_wrist: SE3,
    *,
    truth: Float[Array, "3"] | None = None,
    command: str = "",
    seed: int | None = None,
) -> Page:
    """Everything needed to judge a tool's tip, as one page."""
    said = _remarks(fit, base_from_wrist, truth)
    return Page(
        title="Tool tip",
        summary=_summary(fit, base_from_wrist),
        sections=(
            Section(
                "Result",
                (_facts(fit), Remarks(tuple(said)), _table(fit, truth)),
            ),
            Section("In space", (Figures((_space(fit, base_from_wrist),)),)),
            Section("Residuals", (Figures(tuple(_residuals(fit))),)),
            Section("Covariance", (Figures(tuple(_covariance(fit, truth))),)),
        ),
        footer=Footer(versions=versions(), seed=seed, command=command),
    )


def _summary(fit: ToolFit | PivotFit, poses: SE3) -> str:
    if isinstance(fit, PivotFit):
        return f"The tip on the wrist, from {len(poses)} poses in which it touches one point."
    seen = int(np.isfinite(fit.residuals[..., 0]).sum())
    return (
        f"The tip on the wrist, from {seen} sightings by {len(fit.views)} fixed camera(s) at "
        f"{len(poses)} poses."
    )


def _facts(fit: ToolFit | PivotFit) -> Facts:
    items = []
    for name, value, sigma in zip("xyz", 1000 * fit.tip, 1000 * fit.sigma, strict=True):
        shown, spread = with_sigma(float(value), float(sigma))
        items.append((name, f"{shown} ± {spread} mm", "in the wrist's frame"))
    if isinstance(fit, ToolFit):
        items += [
            ("rms residual", f"{compact(fit.rms_px)} px", "per sighting, both axes together"),
            ("noise σ", f"{compact(fit.noise_px)} px", "per sighting and axis"),
        ]
    else:
        items.append(("noise σ", f"{compact(1000 * fit.noise_m)} mm", "of a touch, per axis"))
    return Facts(tuple(items))


def _remarks(fit: ToolFit | PivotFit, poses: SE3, truth: Float[Array, "3"] | None) -> list[tuple[str, str]]:
    axis, spread, across = turning_axis(poses)
    said = []
    if truth is not None:
        said.append(
            ("note", f"The truth lies {compact(1000 * float(np.linalg.norm(fit.tip - truth)))} mm away.")
        )
    turned = f"The wrist turns by {np.degrees(spread):.0f}° rms about its {axis_in_words(axis)}"
    tone = "good" if np.degrees(across) > 8 else "caution"
    more = "." if tone == "good" else "; more tilt would tell the tip better."
    said.append((tone, f"{turned} and by {np.degrees(across):.0f}° across it{more}"))
    worst = int(np.argmax(fit.sigma))
    if fit.sigma[worst] > 3 * np.median(fit.sigma):
        said.append(("note", f"The tip is known least along the wrist's {'xyz'[worst]} axis."))
    if isinstance(fit, PivotFit):
        said += [
            ("caution", f"Pose {pose + 1} lies far from the point: did the tip slip?") for pose in fit.worst
        ]
    else:
        said += [
            ("caution", f"{name}, pose {pose + 1} was left out: farther off than noise explains.")
            for name, pose in fit.rejected
        ]
        if all(view.known.taken_as_exact for view in fit.views):
            said.append(("note", "The cameras are taken as exact: their files hold no covariance."))
    return said


def _table(fit: ToolFit | PivotFit, truth: Float[Array, "3"] | None) -> Table:
    rows = []
    for i, name in enumerate("xyz"):
        row = [name, *with_sigma(1000 * float(fit.tip[i]), 1000 * float(fit.sigma[i]))]
        if truth is not None:
            error = fit.tip[i] - truth[i]
            row += [
                f"{1000 * truth[i]:.4f}",
                signed(f"{1000 * error:+.4f}"),
                signed(f"{error / fit.sigma[i]:+.1f}"),
            ]
        rows.append(tuple(row))
    columns = ("axis", "value [mm]", "σ [mm]") + (
        ("truth [mm]", "error [mm]", "error / σ") if truth is not None else ()
    )
    return Table(columns, tuple(rows), "The tip in the wrist's frame.", frozenset(range(1, len(columns))))


def _space(fit: ToolFit | PivotFit, poses: SE3) -> Figure:
    tips = poses.apply(fit.tip[None])[:, 0]
    cameras = []
    if isinstance(fit, ToolFit):
        cameras = [
            (view.name, view.known.camera, pose.inverse())
            for view, pose in zip(fit.views, fit.cam_from_base, strict=True)
        ]
    scene = InSpace(
        cameras=cameras,
        frames=[("{B}", SE3.identity())],
        small_frames=poses,
        points=tips,
        lines=np.stack([poses.translation, tips], axis=1),
    )
    return space_figure(
        scene,
        alt="Wrist poses, tips and cameras in space",
        caption="The wrist in every pose and the tip it carries (orange dots), in the base {B}"
        + (", with the cameras." if cameras else ": touching one point."),
    )


def _residuals(fit: ToolFit | PivotFit) -> list[Figure]:
    if isinstance(fit, PivotFit):
        return [
            scatter_rings(
                1000 * fit.residuals[:, list(pair)],
                1000 * fit.noise_m,
                "mm",
                (f"d{'xyz'[pair[0]]}", f"d{'xyz'[pair[1]]}"),
                alt="Residuals of touches",
                caption="How far each touch lies from the common point, in the base, with circles "
                "of the noise.",
            )
            for pair in ((0, 1), (0, 2))
        ]
    figures = []
    for view, residuals in zip(fit.views, fit.residuals, strict=True):
        seen = np.isfinite(residuals[:, 0])
        figures.append(
            residual_arrows(view.known.camera, view.pixels[seen], residuals[seen], title=view.name)
        )
    every = fit.residuals[np.isfinite(fit.residuals[..., 0])]
    figures.append(
        scatter_rings(
            every * [1, -1],
            fit.noise_px,
            "px",
            ("du", "−dv"),
            alt="Scatter of residuals",
            caption="All residuals about one origin, with circles of the noise.",
        )
    )
    return figures


def _covariance(fit: ToolFit | PivotFit, truth: Float[Array, "3"] | None) -> list[Figure]:
    figures = []
    for pair in ((0, 1), (0, 2)):
        plan = np.ix_(pair, pair)
        error = None if truth is None else 1000 * (truth - fit.tip)[list(pair)][None]
        figures.append(
            ellipses(
                np.zeros((1, 2)),
                1e6 * fit.covariance[plan][None],
                (f"off in {'xyz'[pair[0]]}", f"off in {'xyz'[pair[1]]}"),
                caption=f"The tip in the wrist's {'xyz'[pair[0]]}{'xyz'[pair[1]]} plane, off the value found"
                + (", with a line to the truth." if truth is not None else "."),
                errors_mm=error,
            )
        )
    return figures
