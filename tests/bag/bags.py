"""Bags written by rosbags itself, of every kind that is read."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

KINDS = ("ros1", "mcap", "sqlite3")
STORES = {"ros1": Stores.ROS1_NOETIC, "mcap": Stores.ROS2_HUMBLE, "sqlite3": Stores.ROS2_HUMBLE}
IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
START_NS = 1_790_000_000_000_000_000
STEP_NS = 40_000_000


def write_bag(folder: Path, kind: str, topics: Mapping[str, Sequence[dict[str, Any]]]) -> Path:
    """A bag with the messages of each topic, 40 ms apart; gives the path that a person would name."""
    store = get_typestore(STORES[kind])
    if kind == "ros1":
        path = folder / "run.bag"
        writer: Any = Writer1(path)
        serialise = store.serialize_ros1
    else:
        path = folder / f"run_{kind}"
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        writer = Writer2(path, version=9, storage_plugin=plugin)
        serialise = store.serialize_cdr
    with writer:
        for topic, messages in topics.items():
            name = COMPRESSED if messages and "format" in messages[0] else IMAGE
            connection = writer.add_connection(topic, name, typestore=store)
            for index, fields in enumerate(messages):
                time_ns = START_NS + index * STEP_NS
                message = store.types[name](header=_header(store, kind, index, time_ns), **fields)
                # What was recorded late keeps the header's time.
                writer.write(connection, time_ns + 7_000_000, serialise(message, name))
    return path


def _header(store: Any, kind: str, index: int, time_ns: int) -> Any:
    stamp = store.types["builtin_interfaces/msg/Time"](sec=time_ns // 10**9, nanosec=time_ns % 10**9)
    counted = {"seq": index} if kind == "ros1" else {}
    return store.types["std_msgs/msg/Header"](stamp=stamp, frame_id="camera", **counted)


def raw(samples: np.ndarray, encoding: str, *, padding: int = 0, big_endian: bool = False) -> dict[str, Any]:
    """Fields of sensor_msgs/Image; rows may be padded."""
    kind = samples.dtype.newbyteorder(">" if big_endian else "<")
    height, width = samples.shape[:2]
    rows = np.ascontiguousarray(samples.astype(kind)).view(np.uint8).reshape(height, -1)
    rows = np.pad(rows, ((0, 0), (0, padding)), constant_values=77)
    return {
        "height": height,
        "width": width,
        "encoding": encoding,
        "is_bigendian": int(big_endian),
        "step": rows.shape[1],
        "data": rows.ravel(),
    }


def packed(image: np.ndarray, suffix: str = ".png") -> dict[str, Any]:
    """Fields of sensor_msgs/CompressedImage."""
    return {"format": suffix.lstrip("."), "data": cv2.imencode(suffix, image)[1].ravel()}
