"""Tables of a calibration page."""

from collections import Counter

import numpy as np

from vision_robot.calibrate.result import CalibrationResult
from vision_robot.report.calibration_findings import Findings
from vision_robot.report.page import Table
from vision_robot.report.quantity import listed, signed, with_sigma

__all__ = ["parameter_table", "rejection_table", "view_table"]

MOST_ROWS = 60

MEANING = {
    "fx": ("px", "focal length along u"),
    "fy": ("px", "focal length along v"),
    "cx": ("px", "principal point, u"),
    "cy": ("px", "principal point, v"),
    "skew": ("px", "skew of the pixel axes"),
    "k1": ("1", "radial distortion, 1st term"),
    "k2": ("1", "radial distortion, 2nd term"),
    "k3": ("1", "radial distortion, 3rd term"),
    "k4": ("1", "radial distortion, 4th term"),
    "k5": ("1", "radial distortion, 5th term"),
    "k6": ("1", "radial distortion, 6th term"),
    "p1": ("1", "tangential distortion, v"),
    "p2": ("1", "tangential distortion, u"),
}


def parameter_table(findings: Findings) -> Table:
    """Every intrinsic parameter with its sigma, and beside the truth where that is known."""
    result, truth = findings.result, findings.truth
    compared = truth is not None and truth.camera.model == result.camera.model
    columns = ["", "value", "σ", "unit"]
    numeric = {1, 2}
    if compared:
        columns += ["truth", "error", "error / σ"]
        numeric |= {4, 5, 6}
    columns.append("what it is")
    rows = []
    for i, name in enumerate(result.camera.parameter_names):
        value = result.camera.parameters[i]
        unit, meaning = MEANING.get(name, ("1", ""))
        free, known = bool(result.free[i]), name in result.sigma
        shown, sigma = with_sigma(value, result.sigma.get(name, 0.0))
        row = [name, shown, sigma, unit]
        if compared and truth is not None:
            error = value - truth.camera.parameters[i]
            share = truth.error_in_sigma.get(name)
            decimals = len(shown.partition(".")[2])
            row += [
                signed(f"{truth.camera.parameters[i]:.6g}"),
                signed(f"{error:+.{decimals}f}") if known else signed(f"{error:+.3g}" if error else "0"),
                "–" if share is None else signed(f"{share:+.1f}"),
            ]
        state = "" if known else (", not determined by these views" if free else ", held fixed")
        rows.append((*row, meaning + state))
    beside = " beside the camera that made the pictures" if compared else ""
    return Table(
        tuple(columns),
        tuple(rows),
        f"Intrinsic parameters{beside}; σ is one standard deviation, from the noise found in the residuals. "
        f"Lens model {result.camera.model}; pixel (0, 0) is the centre of the first pixel.",
        frozenset(numeric),
    )


def view_table(findings: Findings) -> Table:
    """Each view: its picture, how well it fits, where its board stood."""
    result = findings.result
    rms, left_out = (
        result.view_rms_px,
        Counter(one.image for one in result.rejected if one.corner is not None),
    )
    order = range(len(rms)) if len(rms) <= MOST_ROWS else np.sort(np.argsort(-rms)[:MOST_ROWS])
    rows = tuple(
        (
            str(i + 1),
            result.corners[i].image,
            str(len(result.corners[i])),
            str(left_out[result.corners[i].image]),
            f"{rms[i]:.3f}",
            f"{1000 * findings.distance[i]:.1f}",
            f"{np.degrees(findings.tilt[i]):.1f}",
        )
        for i in order
    )
    only = f" The {MOST_ROWS} with the largest rms are listed." if len(rms) > MOST_ROWS else ""
    return Table(
        ("view", "picture", "corners", "left out", "rms [px]", "distance [mm]", "tilt [°]"),
        rows,
        "The views used: corners used and left out, rms residual per point, distance from the camera to the "
        "middle of the board, "
        f"and tilt of the board against the picture plane.{only}",
        frozenset({0, 2, 3, 4, 5, 6}),
    )


def rejection_table(result: CalibrationResult) -> Table:
    """What was left out, and why."""
    whole = [(one.image, "whole view", one.reason) for one in result.rejected if one.corner is None]
    single: dict[tuple[str, str], list[str]] = {}
    for one in result.rejected:
        if one.corner is not None:
            single.setdefault((one.image, one.reason), []).append(str(one.corner))
    named = [
        (image, f"{'corner' if len(ids) == 1 else 'corners'} {listed(ids, 12)}", reason)
        for (image, reason), ids in single.items()
    ]
    rows = tuple(whole + named)
    rest = f" The first {MOST_ROWS} of {len(rows)} are listed." if len(rows) > MOST_ROWS else ""
    return Table(("picture", "what", "reason"), rows[:MOST_ROWS], f"Left out of the calibration.{rest}")
