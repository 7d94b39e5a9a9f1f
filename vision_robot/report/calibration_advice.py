"""What the page remarks on a calibration: the library's advice, and what only the page knows."""

from collections.abc import Iterator

import numpy as np

from vision_robot.calibrate.judgement.advice import advice_by_topic
from vision_robot.report.calibration_findings import Findings
from vision_robot.report.quantity import compact

__all__ = ["remarks"]

Remark = tuple[str, str]
"""Tone (good, note or caution) and sentence."""


def remarks(findings: Findings) -> tuple[Remark, ...]:
    """Remarks on a calibration, cautions first: a truth missed, then `calibrate.advice` in its order.

    What is good is said only of what the advice has no sentence about.
    """
    topics = advice_by_topic(findings.result)
    said = [*_truth(findings), *(("caution", text) for topic in topics.values() for text in topic)]
    said += _noise(findings)
    said += () if topics["residuals"] else _white(findings)
    said += () if topics["coverage"] else _covered(findings)
    order = {"caution": 0, "note": 1, "good": 2}
    return tuple(sorted(said, key=lambda remark: order[remark[0]]))


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


def _white(findings: Findings) -> Iterator[Remark]:
    near = findings.neighbours
    if not np.isfinite(near.sigma):
        return
    number = f"{compact(near.value, 2)} (noise alone: 0 ± {compact(near.sigma, 1)})"
    if near.z > 2.5:
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


def _covered(findings: Findings) -> Iterator[Remark]:
    yield (
        "good",
        f"The boards cover {compact(100 * findings.covered, 2)} % of the picture, and no edge or corner "
        "that they left out is known much worse than the rest.",
    )


def _probability(p: float) -> str:
    return "p below 0.001" if p < 1e-3 else f"p = {compact(p, 2)}"
