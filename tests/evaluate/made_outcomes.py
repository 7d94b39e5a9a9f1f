"""Outcomes of sweeps that nobody ran."""

from collections.abc import Mapping, Sequence

from vision_robot.evaluate.sweep import Cell, Outcome


def outcomes(
    figures: Mapping[str, Sequence[float]], metric: str = "success_auc", scene: str = "speed"
) -> list[Outcome]:
    """One outcome for each method and seed, the seeds from 0."""
    return [
        Outcome(Cell("trackers", scene, method, seed, "m:f"), {metric: value}, None, 0.1, 1)
        for method, values in figures.items()
        for seed, value in enumerate(values)
    ]
