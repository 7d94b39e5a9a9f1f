"""Sentences that follow from a calibration's numbers, none stronger than they allow."""

from collections.abc import Iterator

import numpy as np

from vision_robot.report.calibration_findings import Findings
from vision_robot.report.quantity import compact, listed

__all__ = ["advice"]

Remark = tuple[str, str]
"""Tone (good, note or caution) and sentence."""

FEW_VIEWS = 10
STEEP = np.radians(20)
CORNER_GAP = 0.15
"""Share of the picture's diagonal past which a picture corner counts as not seen."""
ROUGH = 0.01
"""Share of the diagonal past which uncertainty is no longer proportional to the noise."""


def advice(findings: Findings) -> tuple[Remark, ...]:
    """Remarks on a calibration, what matters most first."""
    remarks = [
        remark
        for rule in (_truth, _undetermined, _whiteness, _noise, _views, _outliers, _tilt, _coverage, _terms)
        for remark in rule(findings)
    ]
    order = {"caution": 0, "note": 1, "good": 2}
    return tuple(sorted(remarks, key=lambda remark: order[remark[0]]))


def _truth(findings: Findings) -> Iterator[Remark]:
    truth = findings.truth
    if truth is None or not truth.error_in_sigma:
        return
    worst = max(truth.error_in_sigma, key=lambda name: abs(truth.error_in_sigma[name]))
    size = compact(abs(truth.error_in_sigma[worst]), 2)
    joint = (
        f"chi-square {compact(truth.chi_square)} for {len(truth.error_in_sigma)} parameters, "
        f"{_probability(truth.probability)}"
    )
    if truth.probability < 1e-3 or abs(truth.error_in_sigma[worst]) > 4:
        yield (
            "caution",
            f"The truth lies farther away than the stated uncertainty allows ({worst} by {size} sigma; "
            f"{joint}): "
            "the lens model, the board or the corners err in a way that noise does not.",
        )
    else:
        yield (
            "good",
            "The truth lies where the stated uncertainty says it should: no parameter is off by "
            f"more than {size} sigma ({worst}); {joint}.",
        )


def _undetermined(findings: Findings) -> Iterator[Remark]:
    lost = findings.result.covariance.undetermined
    if lost:
        yield (
            "caution",
            f"These views do not determine {listed(lost)}: no sigma is stated for them, and the projection "
            "uncertainty below leaves them out.",
        )


def _whiteness(findings: Findings) -> Iterator[Remark]:
    near = findings.neighbours
    if not np.isfinite(near.sigma):
        return
    number = f"{compact(near.value, 2)} (noise alone: 0 ± {compact(near.sigma, 1)})"
    if near.z > 4 and near.value > 0.1:
        yield (
            "caution",
            f"Residuals of neighbouring corners correlate by {number}: the lens or board model is too "
            "simple, or "
            "the corner detector errs by place. What is systematic is in no sigma of this page, "
            "so all of them are too small.",
        )
    elif near.z > 2.5:
        yield (
            "note",
            f"Residuals of neighbouring corners correlate a little, by {number}: a small systematic error "
            f"{'remains' if near.z > 4 else 'may remain'}.",
        )
    elif near.z >= -2.5:
        yield ("good", f"Residuals of neighbouring corners do not correlate measurably: {number}.")


def _noise(findings: Findings) -> Iterator[Remark]:
    factor = findings.stated_noise_factor
    if findings.stated and factor > 1.5:
        yield (
            "note",
            f"The corners scatter {compact(factor, 2)} times as much as their detector stated; "
            "all sigmas here use the scatter found.",
        )


def _views(findings: Findings) -> Iterator[Remark]:
    result = findings.result
    used = len(result.corners)
    if used < FEW_VIEWS:
        yield (
            "note",
            f"{used} views were used. With noise alone, twice as many of the same kind would make every "
            "sigma smaller by a factor of about 1.4.",
        )
    near, far = float(np.nanmin(findings.distance)), float(np.nanmax(findings.distance))
    if far < 1.25 * near:
        yield (
            "note",
            "All boards stood at nearly the same distance, "
            f"{compact(1000 * near)} to {compact(1000 * far)} mm; nearer and farther ones "
            "would test the lens model better.",
        )


def _outliers(findings: Findings) -> Iterator[Remark]:
    result = findings.result
    rms = result.view_rms_px
    worst = np.flatnonzero(findings.outlying)[np.argsort(-rms[findings.outlying])]
    if len(worst):
        named = [f"view {i + 1} ({result.corners[i].image}) {compact(float(rms[i]), 2)} px" for i in worst]
        yield (
            "caution",
            f"Much worse than the median view ({compact(float(np.median(rms)), 2)} px): {listed(named, 4)}. "
            "Look whether the picture is blurred, the board bent, or a corner misplaced.",
        )


def _tilt(findings: Findings) -> Iterator[Remark]:
    steep = findings.tilt >= STEEP
    largest = compact(float(np.degrees(findings.tilt.max())), 2)
    if steep.sum() < 3:
        yield (
            "caution",
            f"Only {steep.sum()} of {len(steep)} views tilt the board by 20° or more against the picture "
            "plane "
            f"(the most: {largest}°): tilt is what tells the focal length from the distance. "
            "Add views tilted by 20° to 60° in different directions.",
        )
        return
    normal = findings.result.cam_from_board.rotation[:, :2, 2]
    values, vectors = np.linalg.eigh(normal.T @ normal / len(normal))
    if np.sqrt(max(values[0], 0)) < 0.15 * np.sqrt(values[1]):
        horizontal = abs(vectors[0, 1]) > abs(vectors[1, 1])
        about, missing = ("vertical", "horizontal") if horizontal else ("horizontal", "vertical")
        yield (
            "note",
            f"Nearly all tilts turn the board about one, more or less {about}, axis; tilts about "
            f"the {missing} axis would add what is missing.",
        )


def _coverage(findings: Findings) -> Iterator[Remark]:
    camera = findings.result.camera
    diagonal = float(np.hypot(camera.width, camera.height))
    far = [name for name, gap in findings.gap_px.items() if gap > CORNER_GAP * diagonal]
    sigma = findings.sigma_at_infinity
    if np.isnan(sigma).any():
        yield (
            "caution",
            f"In {compact(100 * float(np.isnan(sigma).mean()), 2)} % of the picture the fitted lens folds "
            "over and "
            "has no ray: nothing can be measured there.",
        )
    if far:
        largest = compact(float(np.nanmax(sigma)), 2)
        smallest = compact(float(np.nanmin(sigma)), 2)
        corners = "corner" if len(far) == 1 else "corners"
        rough = (
            " (so large that it tells no more than the order)" if np.nanmax(sigma) > ROUGH * diagonal else ""
        )
        yield (
            "caution",
            f"No board corner was seen within {compact(CORNER_GAP * diagonal, 2)} px of the {listed(far)} "
            f"{corners} "
            "of the picture. The lens is extrapolated there: the projection uncertainty goes from "
            f"{smallest} px "
            f"up to {largest} px{rough}. Add views that reach into the corners.",
        )
    else:
        yield (
            "good",
            f"The boards cover {compact(100 * findings.covered, 2)} % of the picture and come near all four "
            "of "
            "its corners.",
        )


def _terms(findings: Findings) -> Iterator[Remark]:
    result = findings.result
    values = dict(zip(result.camera.parameter_names, result.camera.parameters, strict=True))
    optional = ["skew", *result.camera.lens.coefficient_names]
    small = [
        name
        for name in optional
        if name not in result.settings.priors
        and result.sigma.get(name, 0) > 0
        and abs(values[name]) < 2 * result.sigma[name]
    ]
    if small:
        which = f"{small[0]} does" if len(small) == 1 else f"Taken one at a time, {listed(small)} do"
        without = "it" if len(small) == 1 else "one of them"
        yield (
            "note",
            f"{which} not differ from zero by two sigma: a model without {without} may predict as well. "
            "Views held back from the fit would tell; the rms cannot.",
        )


def _probability(p: float) -> str:
    return "p below 0.001" if p < 1e-3 else f"p = {compact(p, 2)}"
