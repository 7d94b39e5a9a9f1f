"""The table of metrics, from the registry that benchmarks print by."""

from vision_robot.evaluate.metrics import METRICS

__all__ = ["metrics_table"]


def metrics_table() -> str:
    """Markdown to be included by the page of metrics."""
    rows = ["| metric | unit | better | meaning | no practical difference below |", "|---|---|---|---|---|"]
    for one in METRICS.values():
        zone = f"{100 * one.relative_zone:g} %" if one.relative_zone else f"{one.zone:g} {one.unit}"
        rows.append(f"| `{one.name}` | {one.unit} | {one.better} | {one.meaning} | {zone} |")
    return "\n".join([*rows, ""])
