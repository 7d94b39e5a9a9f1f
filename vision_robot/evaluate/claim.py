"""A claim that one method is better than others, asked of every axis of difficulty and of all together."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from vision_robot.evaluate.conclusion import (
    Comparison,
    compare_methods,
    needed_words,
    range_words,
    unit_words,
)
from vision_robot.evaluate.statistics import holm
from vision_robot.evaluate.sweep import Outcome

__all__ = ["Claim", "Finding", "claim_words", "findings"]

Verdict = Literal["holds", "fails", "equal", "open"]


@dataclass(frozen=True)
class Claim:
    """That `method` is better than each of `rivals`."""

    who: str
    """Who says it, such as "the text"."""
    method: str
    rivals: tuple[str, ...]


@dataclass(frozen=True)
class Finding:
    """What the scenes of one axis, at all severities, say of a claim; or those of all axes."""

    axis: str
    """Empty for all scenes together."""
    pairs: tuple[Comparison, ...]
    """With each rival, corrected for their number."""
    means: dict[str, float]
    """Of the claim's method and its rivals."""
    failed: int
    """Scenes and seeds on which the claim's method failed and a rival did not."""

    def verdict(self, method: str) -> Verdict:
        """`holds` if it is better than every rival, `fails` if one is better than it, `equal`, or `open`."""
        behind = [one for one in self.pairs if one.verdict == "better" and one.worse == method]
        ahead = [one for one in self.pairs if one.verdict == "better" and one.better == method]
        if behind:
            return "fails"
        if self.failed:
            return "open"
        if len(ahead) == len(self.pairs):
            return "holds"
        settled = ahead + [one for one in self.pairs if one.verdict in ("equivalent", "same")]
        return "equal" if len(settled) == len(self.pairs) else "open"


def findings(outcomes: Iterable[Outcome], metric: str, claim: Claim) -> list[Finding]:
    """All scenes together first, then axis by axis; a scene without severity is an axis of its own.

    Each is a question of its own: its tests are corrected for its rivals, not for the number of axes.
    """
    names = (claim.method, *claim.rivals)
    mine = [one for one in outcomes if one.cell.method in names]
    axes = dict.fromkeys(_axis(one.cell.scene) for one in mine)
    found = [_finding(mine, "", metric, claim)]
    if len(axes) > 1:
        found += [
            _finding([one for one in mine if _axis(one.cell.scene) == axis], axis, metric, claim)
            for axis in axes
        ]
    return [one for one in found if one.pairs]


def claim_words(found: Sequence[Finding], claim: Claim) -> list[str]:
    """The claim and what became of it, in sentences no stronger than the numbers."""
    if not found:
        return []
    whole, axes = found[0], found[1:]
    metric = whole.pairs[0].metric
    rivals = " and ".join(claim.rivals)
    said = f"{claim.who[0].upper()}{claim.who[1:]} says that {claim.method} is better than {rivals}"
    seeds = min(one.difference.n for one in whole.pairs)
    overall = {
        "holds": "over all scenes together that holds",
        "fails": "over all scenes together that does not hold",
        "equal": "over all scenes together it is no worse, and practically equal to one at least",
        "open": "over all scenes together that is not settled",
    }[whole.verdict(claim.method)]
    words = [f"{said}. In {metric.name}, {overall} ({seeds} seeds): {_pairs(whole)}."]
    openings: dict[Verdict, str] = {
        "holds": "It holds on {}",
        "fails": "It does not hold on {}",
        "equal": "No difference that matters on {}",
        "open": "Not settled on {}",
    }
    for verdict, text in openings.items():
        those = [one for one in axes if one.verdict(claim.method) == verdict]
        if those:
            words.append(text.format("; ".join(_axis_words(one, verdict, claim) for one in those)) + ".")
    if axes:
        words.append(
            "Each axis is asked by itself, at 5 %: of twenty that show nothing one may be told wrongly."
        )
    return words


def _axis(scene: str) -> str:
    name, equals, _ = scene.rpartition("=")
    return name if equals else scene


def _finding(outcomes: Sequence[Outcome], axis: str, metric: str, claim: Claim) -> Finding:
    names = (claim.method, *claim.rivals)
    alone = [
        pair
        for rival in claim.rivals
        for pair in compare_methods(outcomes, metric, None, (claim.method, rival))
    ]
    pairs = [
        replace(pair, p=float(p)) for pair, p in zip(alone, holm([pair.p for pair in alone]), strict=True)
    ]
    means = {}
    for name in names:
        values = [one.figures[metric] for one in outcomes
                  if one.cell.method == name and np.isfinite(one.figures.get(metric, np.nan))]  # fmt: skip
        means[name] = float(np.mean(values)) if values else np.nan
    lost, kept = (
        {
            (one.cell.scene, one.cell.seed)
            for one in outcomes
            if (one.cell.method == claim.method) == mine and (one.failure is not None) == mine
        }
        for mine in (True, False)
    )
    return Finding(axis, tuple(pairs), means, len(lost & kept))


def _axis_words(one: Finding, verdict: Verdict, claim: Claim) -> str:
    values = ", ".join(f"{name} {value:.2f}" for name, value in one.means.items())
    if verdict == "open":
        needed = "; ".join(needed_words(pair) for pair in one.pairs if pair.verdict == "open")
        return f"{one.axis} ({values}; {needed})"
    if verdict == "fails":
        ahead = " and ".join(pair.better for pair in one.pairs
                             if pair.verdict == "better" and pair.worse == claim.method)  # fmt: skip
        verb = "are" if " and " in ahead else "is"
        return f"{one.axis}, where {ahead} {verb} better ({values})"
    return f"{one.axis} ({values})"


def _pairs(one: Finding) -> str:
    unit = unit_words(one.pairs[0].metric)
    return ", ".join(
        f"{pair.better} before {pair.worse} by {pair.difference.value:.2g}{unit} "
        f"({range_words(pair.difference)}, p = {pair.p:.2g})"
        for pair in one.pairs
    )
