"""Who is to blame for an error: stages replaced by the truth, one by one and together."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import factorial

from vision_robot.errors import BadParameter

__all__ = ["Attribution", "attribute", "subsets"]


@dataclass(frozen=True)
class Attribution:
    """An error shared out among stages.

    `share` adds up to `total - floor`: the error as it is less what stays when every stage is the truth.
    `alone` is what is saved by mending one stage only, and `last` what that stage costs when all others are
    right; where the two differ, the stage acts together with others.
    """

    total: float
    floor: float
    share: Mapping[str, float]
    alone: Mapping[str, float]
    last: Mapping[str, float]


def subsets(stages: Sequence[str]) -> Iterator[frozenset[str]]:
    """All sets of stages that may be replaced by the truth: the runs that `attribute` needs."""
    for size in range(len(stages) + 1):
        yield from map(frozenset, combinations(stages, size))


def attribute(stages: Sequence[str], error_when_true: Mapping[frozenset[str], float]) -> Attribution:
    """Shapley values (1953) of stages from the error with each set of them replaced by the truth.

    A stage's share is what its mending saves, averaged over all orders in which stages may be mended: the
    one division that is fair to equals, gives nothing to stages that do nothing, and adds up.
    Raises BadParameter where a set is missing.
    """
    missing = [sorted(one) for one in subsets(stages) if one not in error_when_true]
    if missing:
        raise BadParameter("counterfactual runs", f"without {missing[0]}", "one for each set of stages")
    n = len(stages)
    share = {}
    for stage in stages:
        others = [one for one in stages if one != stage]
        share[stage] = sum(
            factorial(len(mended))
            * factorial(n - len(mended) - 1)
            / factorial(n)
            * (error_when_true[mended] - error_when_true[mended | {stage}])
            for mended in subsets(others)
        )
    nothing, everything = frozenset[str](), frozenset(stages)
    total, floor = error_when_true[nothing], error_when_true[everything]
    return Attribution(
        total,
        floor,
        share,
        alone={one: total - error_when_true[frozenset({one})] for one in stages},
        last={one: error_when_true[everything - {one}] - floor for one in stages},
    )
