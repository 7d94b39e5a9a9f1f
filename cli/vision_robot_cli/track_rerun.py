"""Tracks for the viewer rerun, an extra: pip install 'vision-robot[rerun]'."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.errors import MissingPackage
from vision_robot.files import atomic_path
from vision_robot.track.session import Step
from vision_robot.types import Array, Float, Image

__all__ = ["check_rerun", "rerun_sink"]

MASK_COLOUR = (255, 190, 0)


def check_rerun() -> Any:
    """The package rerun; raises MissingPackage where it is not installed."""
    try:
        import rerun  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise MissingPackage("rerun-sdk", "a recording for the viewer rerun") from error
    return rerun


@contextmanager
def rerun_sink(path: Path, mask: Callable[[], Image]) -> Iterator[Callable[[Step], None]]:
    """A function that logs each step into a recording (*.rrd), which appears at `path` at the end.

    Logged are the frame, the tracker's `mask`, each object's box, major axis and id, its speed and yaw,
    and where it is on the work plane if there is one.
    """
    rerun = check_rerun()
    with atomic_path(path) as temporary:
        recording = rerun.RecordingStream("vision_robot")
        recording.save(str(temporary))
        recording.log("frame", rerun.AnnotationContext([(1, "mask", MASK_COLOUR)]), static=True)
        yield lambda step: _log(rerun, recording, step, mask())
        recording.flush()
        recording.disconnect()


def _log(rerun: Any, recording: Any, step: Step, mask: Image) -> None:
    recording.set_time("video", duration=step.frame.time_s)
    image = step.frame.image
    recording.log("frame", rerun.Image(image, color_model="BGR" if image.ndim == 3 else "L").compress(80))
    recording.log("frame/mask", rerun.SegmentationImage((mask > 0).astype(np.uint8)))
    rows = step.now
    labels = [str(one) for one in rows.id]
    kind = rerun.Box2DFormat.XYWH
    recording.log("frame/boxes", rerun.Boxes2D(array=rows.box_px, array_format=kind, labels=labels))
    recording.log("frame/axes", rerun.LineStrips2D(_axes(rows.centroid_px, rows.axes_px, rows.yaw_rad)))
    for i, one in enumerate(labels):
        speed = float(np.hypot(rows.extra["vu_px_s"][i], rows.extra["vv_px_s"][i]))
        recording.log(f"speed_px_s/{one}", rerun.Scalars(speed))
        recording.log(f"yaw_deg/{one}", rerun.Scalars(float(np.degrees(rows.yaw_rad[i]))))
    placed = step.placed
    if placed is None:
        return
    recording.log("plane_mm", rerun.Points2D(1000 * placed.position_m, labels=labels))
    for i, one in enumerate(labels):
        speed = float(1000 * np.hypot(*placed.velocity_m_s[i]))
        recording.log(f"speed_mm_s/{one}", rerun.Scalars(speed))


def _axes(
    centres: Float[Array, "n 2"], lengths: Float[Array, "n 2"], yaw: Float[Array, "n"]
) -> list[Float[Array, "2 2"]]:
    """The major axes as lines in the picture."""
    half = 0.5 * lengths[:, :1] * np.stack([np.cos(yaw), np.sin(yaw)], axis=-1)
    return [np.stack([centre - one, centre + one]) for centre, one in zip(centres, half, strict=True)]
