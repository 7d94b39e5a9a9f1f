"""The table of tracked objects."""

import numpy as np

from vision_robot.report.page import Table
from vision_robot.report.quantity import compact
from vision_robot.track.history import History

__all__ = ["track_table"]

MOST_ROWS = 60


def track_table(history: History, *, metric: bool) -> Table:
    """Each object: when it was seen, where it began and ended, how fast and how large it was."""
    paths = history.longest(MOST_ROWS)
    unit = "mm" if metric else "px"
    place = ("x_mm", "y_mm") if metric else ("u_px", "v_px")
    rate = ("vx_mm_s", "vy_mm_s") if metric else ("vu_px_s", "vv_px_s")
    rows = []
    for path in paths:
        table = path.table
        speed = np.hypot(table[rate[0]], table[rate[1]])
        speed = speed[np.isfinite(speed)]
        turned = table["yaw_deg"][np.isfinite(table["yaw_deg"])]
        first, last = ([compact(table[one][k], 4) for one in place] for k in (0, -1))
        rows.append(
            (
                str(path.id),
                f"{table['time_s'][0]:.2f}",
                f"{table['time_s'][-1]:.2f}",
                str(path.count),
                ", ".join(first),
                ", ".join(last),
                compact(float(np.median(speed))) if len(speed) else "–",
                compact(float(np.median(table["area_px"]))),
                f"{turned[-1] - turned[0]:.0f}" if len(turned) > 1 else "–",
            )
        )
    left = len(history.paths) + history.dropped - len(paths)
    rest = f" {left} shorter track(s) are not listed." if left > 0 else ""
    columns = ("id", "from [s]", "to [s]", "rows", f"began [{unit}]", f"ended [{unit}]")
    return Table(
        (*columns, f"speed [{unit}/s]", "area [px]", "turned [°]"),
        tuple(rows),
        f"The objects; speed and area are medians, turned is the change of yaw.{rest}",
        frozenset({0, 1, 2, 3, 6, 7, 8}),
    )
