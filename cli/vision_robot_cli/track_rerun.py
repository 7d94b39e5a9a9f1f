"""Tracks for the viewer rerun, an extra: pip install 'vision-robot[rerun]'."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.track.session import Step

__all__ = ["rerun_sink"]


def rerun_sink(path: Path) -> Callable[[Step], None]:
    """A function that logs each step into a recording at `path` (*.rrd)."""
    try:
        import rerun  # pyright: ignore[reportMissingImports]
    except ImportError:
        wanted = "left out, or rerun installed: pip install rerun-sdk"
        raise BadParameter("--rerun", str(path), wanted) from None
    recording = rerun.RecordingStream("vision_robot")
    recording.save(str(path))

    def log(step: Step) -> None:
        recording.set_time("video", duration=step.frame.time_s)
        image = rerun.Image(step.frame.image, color_model="BGR" if step.frame.image.ndim == 3 else "L")
        recording.log("frame", image.compress(jpeg_quality=80))
        rows = step.now
        boxes = rerun.Boxes2D(
            array=rows.box_px, array_format=rerun.Box2DFormat.XYWH, labels=[str(one) for one in rows.id]
        )
        recording.log("frame/objects", boxes)
        for i, one in enumerate(rows.id.tolist()):
            recording.log(f"speed_px_s/{one}", rerun.Scalars(float(np.hypot(*_velocity(rows, i)))))

    return log


def _velocity(rows, i: int) -> tuple[float, float]:
    return float(rows.extra["vu_px_s"][i]), float(rows.extra["vv_px_s"][i])
