"""Files of dense optical flow: KITTI's 16-bit PNG and Middlebury's .flo.

In the PNG red is ``64 u + 32768``, green ``64 v + 32768``; blue is 0 where the flow is unknown, 1 where
it is known, and in files of ours 2 where the point is hidden in the second frame, which
KITTI's own reader takes for 1. A .flo has no place for that.
"""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from vision_robot.errors import BadParameter, BadTable
from vision_robot.files import write_bytes
from vision_robot.images import decoded
from vision_robot.reading import LARGEST_PICTURE, read_bytes
from vision_robot.types import Array, Bool, Float

__all__ = ["FlowField", "encode_flow", "read_flow", "write_flow"]

SCALE, OFFSET = 64, 32768
LARGEST_PX = 511.0
MAGIC = np.float32(202021.25)
UNKNOWN = 1e9
"""Middlebury: larger components mean that the flow is unknown."""
FASTEST = [
    cv2.IMWRITE_PNG_STRATEGY,
    cv2.IMWRITE_PNG_STRATEGY_RLE,
    cv2.IMWRITE_PNG_FILTER,
    cv2.IMWRITE_PNG_FILTER_UP,
]
"""Fields of flow are smooth down the columns; a third of the time of OpenCV's choice."""


@dataclass(frozen=True)
class FlowField:
    """Where each pixel goes to."""

    flow_px: Float[Array, "height width 2"]
    """(du, dv); NaN where it is unknown."""
    occluded: Bool[Array, "height width"]
    """Known, but hidden in the second frame, or out of it."""

    @property
    def known(self) -> Bool[Array, "height width"]:
        """Where the flow is known."""
        return np.isfinite(self.flow_px[..., 0])


def encode_flow(field: FlowField, suffix: str) -> bytes:
    """The bytes of a file with that suffix, .png or .flo. Raises BadParameter for another one."""
    if suffix == ".flo":
        height, width = field.flow_px.shape[:2]
        values = np.where(field.known[..., None], field.flow_px, 10 * UNKNOWN).astype("<f4")
        return MAGIC.tobytes() + np.array([width, height], dtype="<i4").tobytes() + values.tobytes()
    if suffix != ".png":
        raise BadParameter("flow file", f"*{suffix}", "named *.png or *.flo")
    flow = np.ascontiguousarray(field.flow_px, dtype=np.float32)
    known = cv2.inRange(flow, (-LARGEST_PX,) * 2, (LARGEST_PX,) * 2) != 0  # not so where it is no number
    codes = cv2.addWeighted(flow, SCALE, flow, 0, OFFSET, dtype=cv2.CV_16U)
    if not known.all():
        codes[~known] = 0
    marks = known.astype(np.uint16)
    marks += known & field.occluded
    raw = np.empty((*known.shape, 3), dtype=np.uint16)
    cv2.mixChannels([marks, codes], [raw], [0, 0, 2, 1, 1, 2])
    return cv2.imencode(".png", raw, FASTEST)[1].tobytes()


def write_flow(field: FlowField, path: Path | str) -> None:
    """Write a .png (to 1/128 px) or a .flo (all digits, without what is occluded), whole or not at all."""
    write_bytes(path, encode_flow(field, Path(path).suffix.lower()))


def read_flow(path: Path | str) -> FlowField:
    """Read a .png or a .flo. Raises BadTable for a file that holds no flow."""
    if Path(path).suffix.lower() == ".flo":
        return _from_flo(read_bytes(path, BadTable, LARGEST_PICTURE), path)
    return _from_png(decoded(path, BadTable), path)


def _from_flo(data: bytes, path: Path | str) -> FlowField:
    if len(data) < 12 or np.frombuffer(data[:4], "<f4")[0] != MAGIC:
        raise BadTable(path, "it is no .flo file: it does not start with 202021.25")
    width, height = np.frombuffer(data[4:12], "<i4").tolist()
    if not (0 < width < 100_000 and 0 < height < 100_000):
        raise BadTable(path, f"its size is {width}x{height}")
    if len(data) != 12 + 8 * width * height:
        raise BadTable(path, f"{width}x{height} px need {12 + 8 * width * height} bytes, it has {len(data)}")
    flow = np.frombuffer(data[12:], "<f4").reshape(height, width, 2).astype(np.float32)
    unknown = ~(np.abs(flow) <= UNKNOWN).all(axis=-1)
    flow[unknown] = np.nan
    return FlowField(flow, np.zeros(unknown.shape, dtype=bool))


def _from_png(raw: np.ndarray, path: Path | str) -> FlowField:
    if raw.dtype != np.uint16 or raw.ndim != 3 or raw.shape[2] != 3:
        raise BadTable(path, f"flow is 3 x 16 bits a pixel, this has {raw.dtype} {raw.shape}")
    flow = (raw[..., :0:-1].astype(np.float32) - OFFSET) / SCALE
    flow[raw[..., 0] == 0] = np.nan
    return FlowField(flow, raw[..., 0] == 2)
