"""Drawings of a hand-eye calibration: residuals, ellipses, foretold against held out."""

from typing import TYPE_CHECKING, Any

import numpy as np

from vision_robot.calibrate.hand_eye import HandEyeResult
from vision_robot.calibrate.hand_eye.judgement.held_out import HeldOutViews
from vision_robot.geometry.hand_eye import HandEye
from vision_robot.report.figure import ACCENT, FAINT, INK, WARM, WIDTH_IN, draw, segments
from vision_robot.report.page import Figure
from vision_robot.report.quantity import compact

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

__all__ = ["arm_residual_bars", "foretold_scatter", "position_ellipses", "predicted_scatter"]

MOST_MARKS = 4000
MOST_BARS = 120
CLOSED_FORM_MARKS = {"tsai-lenz": "v", "park-martin": "s", "daniilidis": "D", "shah": "^"}


def arm_residual_bars(result: HandEyeResult) -> Figure:
    """Shift and turn of each view between what the arm says and what the picture says."""
    off = result.arm_residuals
    shift, turn = 1e3 * np.linalg.norm(off[:, 3:], axis=1), np.degrees(np.linalg.norm(off[:, :3], axis=1))
    noise = result.noise.noise
    number = np.arange(1, len(off) + 1)

    def paint(canvas: "Canvas") -> None:
        rows = ((shift, "shift [mm]", 1e3 * noise.shift_m), (turn, "turn [°]", np.degrees(noise.turn)))
        for k, (values, label, sigma) in enumerate(rows):
            axes = canvas.add_subplot(2, 1, k + 1)
            axes.bar(number, values, width=0.72, color=ACCENT)
            axes.axhline(1.54 * sigma, color=INK, linewidth=0.8)
            axes.set_ylabel(label)
            axes.set_xlim(0.3, len(off) + 0.7)
            axes.set_xlabel("view" if k else "")
            _whole_ticks(axes)
        canvas.subplots_adjust(hspace=0.28)

    return Figure(
        draw(paint, height_in=0.86 * WIDTH_IN),
        alt="Bars of the shift and the turn between arm and picture for each view",
        caption="What the arm says of its wrist less what the pictures say, length over all axes. The line "
        "is the "
        f"median that the arm's estimated noise makes ({compact(1e3 * noise.shift_m)} mm and "
        f"{compact(float(np.degrees(noise.turn)))}° per axis).",
    )


def predicted_scatter(result: HandEyeResult) -> Figure:
    """Corners where the arm predicts them less where they were seen."""
    every = np.concatenate(result.predicted_residuals)
    skip = max(1, -(-len(every) // MOST_MARKS))
    shown = every[::skip]
    reach = 1.08 * max(float(np.abs(every).max()), 1e-9)

    def paint(canvas: "Canvas") -> None:
        axes = canvas.add_subplot()
        axes.set_aspect("equal")
        axes.axhline(0, color=FAINT, linewidth=0.6, zorder=0)
        axes.axvline(0, color=FAINT, linewidth=0.6, zorder=0)
        segments(axes, shown, colour=ACCENT, width=1.8)
        axes.set_xlim(-reach, reach)
        axes.set_ylim(reach, -reach)
        axes.set_xlabel("du [px]")
        axes.set_ylabel("dv [px]")

    thinned = f" One corner in {skip} is drawn." if skip > 1 else ""
    return Figure(
        draw(paint, height_in=0.8 * WIDTH_IN),
        alt="Scatter of predicted less seen corners",
        caption="Corners where the arm's pose and this calibration predict them, less where they were seen: "
        f"{compact(result.rms_px)} px rms. Each cluster is one view, moved as a whole by the arm's error in "
        "it; the "
        f"corners' own noise is {compact(result.noise_px)} px.{thinned}",
    )


def position_ellipses(result: HandEyeResult, truth: HandEye | None) -> Figure:
    """Where the camera sits: 95 % ellipses in three planes, with the closed forms and the truth."""
    found = 1e3 * result.mount_from_cam.translation
    C = 1e6 * result.covariance.mount_from_cam[3:, 3:]
    forms = {name: 1e3 * mount.translation - found for name, (mount, _) in result.closed_forms.items()}
    true = None if truth is None else 1e3 * truth.mount_from_cam.translation - found
    radius = float(np.sqrt(5.991))
    sigma = radius * float(np.sqrt(np.diag(C).max()))
    marks = [*forms.values(), *([] if true is None else [true])]
    near = [np.abs(m).max() for m in marks if np.abs(m).max() < 6 * sigma]
    reach = 1.15 * max([sigma, *near])

    def paint(canvas: "Canvas") -> None:
        turn = np.linspace(0, 2 * np.pi, 121)
        circle = radius * np.stack([np.cos(turn), np.sin(turn)])
        for k, (i, j) in enumerate(((0, 1), (0, 2), (1, 2))):
            axes = canvas.add_subplot(1, 3, k + 1)
            axes.set_aspect("equal")
            ring = np.linalg.cholesky(C[np.ix_([i, j], [i, j])]) @ circle
            axes.fill(*ring, color=ACCENT, alpha=0.12, linewidth=0)
            axes.plot(*ring, color=ACCENT)
            axes.plot(0, 0, "+", color=ACCENT, markersize=7)
            for name, offset in forms.items():
                axes.plot(
                    offset[i], offset[j], CLOSED_FORM_MARKS[name], color=FAINT, markeredgecolor=INK,
                    markersize=4.5, markeredgewidth=0.6, linestyle="none", label=name,
                )  # fmt: skip
            if true is not None:
                axes.plot(true[i], true[j], "x", color=WARM, markersize=6, linestyle="none", label="truth")
            axes.set_xlim(-reach, reach)
            axes.set_ylim(-reach, reach)
            axes.set_xlabel(f"{'xyz'[i]} [mm]")
            axes.set_ylabel(f"{'xyz'[j]} [mm]")
        handles, labels = canvas.axes[0].get_legend_handles_labels()
        canvas.legend(handles, labels, loc="upper center", ncols=5, handletextpad=0.1, columnspacing=1.0)
        canvas.subplots_adjust(wspace=0.62, top=0.86)

    outside = len(marks) - len(near)
    far = f" {outside} lie outside the drawing." if outside else ""
    return Figure(
        draw(paint, height_in=0.46 * WIDTH_IN),
        alt="Ellipses of the camera's position in three planes",
        caption=f"Where the camera sits in the {result.setup.mount}'s frame, about what was found: ellipses "
        "hold the "
        f"truth in 95 of 100 calibrations; closed forms from the same views beside.{far}",
    )


def foretold_scatter(held_out: HeldOutViews) -> Figure:
    """Errors of held-out views against what the others foretell."""

    def paint(canvas: "Canvas") -> None:
        rows = (
            (1e3 * held_out.foretold_shift_m, 1e3 * held_out.shift_m, "mm"),
            (np.degrees(held_out.foretold_turn), np.degrees(held_out.turn), "°"),
        )
        for k, (foretold, found, unit) in enumerate(rows):
            axes = canvas.add_subplot(1, 2, k + 1)
            top = 1.1 * max(float(found.max()), 2 * float(foretold.max()))
            right = 1.1 * float(foretold.max())
            line = np.array([0, right])
            axes.plot(line, line, color=INK, linewidth=0.8)
            axes.plot(line, 2 * line, color=FAINT, linewidth=0.8)
            segments(axes, np.column_stack([foretold, found]), colour=ACCENT, width=3.0)
            axes.set_xlim(0, right)
            axes.set_ylim(0, top)
            axes.set_xlabel(f"foretold, one sigma [{unit}]")
            axes.set_ylabel(f"held out [{unit}]")
        canvas.subplots_adjust(wspace=0.32)

    return Figure(
        draw(paint, height_in=0.5 * WIDTH_IN),
        alt="Held-out errors against foretold ones, shift and turn",
        caption="Each view left out in turn: how far the wrist was from where the others put it, against "
        "the standard "
        "deviation they foretell, all axes together. Dark line: as foretold; light line: twice that. Over "
        "all views "
        f"the errors are {compact(held_out.ratio)} times what was foretold.",
    )


def _whole_ticks(axes: Any) -> None:
    from matplotlib.ticker import MaxNLocator

    axes.xaxis.set_major_locator(MaxNLocator(nbins=10, integer=True, min_n_ticks=1))
