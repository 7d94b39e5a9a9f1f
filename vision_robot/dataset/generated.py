"""Our own layout: what `vr synth` writes.

dataset.json says everything; frames and the truth lie where it says (patterns count from 0). It is
a file of camera and work plane too.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.dataset.dataset import Dataset, DatasetObject, even_times
from vision_robot.dataset.folder import inside, picture_size
from vision_robot.dataset.layout import Layout
from vision_robot.errors import BadCameraFile, BadDataset
from vision_robot.formats import read_camera
from vision_robot.formats.intrinsics import MAX_SIDE
from vision_robot.formats.parse import parse_json
from vision_robot.formats.pose import read_pose
from vision_robot.formats.source import open_source
from vision_robot.geometry import SE3
from vision_robot.reading import LARGEST_TABLE, csv_rows, json_tree, read_text
from vision_robot.tracks import Tracks

__all__ = ["LAYOUT", "SCHEMA"]

SCHEMA = "vr.dataset/1"
MOST_FRAMES = 1_000_000
"""As many as a recipe may ask for."""
PATTERN = re.compile(r"[\w./-]*\{:0\dd\}\.\w+")


def recognises(folder: Path) -> bool:
    """A folder with a dataset.json."""
    return (folder / "dataset.json").is_file()


def read(folder: Path) -> Dataset:
    """A dataset of ours: a video with truth, or a set of calibration views (which has no tracks).

    Raises BadDataset, naming the key, for a dataset.json that is damaged or tells what is not there.
    """
    path = folder / "dataset.json"
    described = json_tree(read_text(path, BadDataset), path, BadDataset)
    if not isinstance(described, dict) or described.get("schema") != SCHEMA:
        raise BadDataset(path, f"its schema is not {SCHEMA}")
    try:
        return _views(folder, described) if "views" in described else _video(folder, described)
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        what = f"key {error} is missing" if isinstance(error, KeyError) else str(error)
        raise BadDataset(path, f"it is not as this tool writes it: {what}") from error


def _video(folder: Path, described: dict[str, Any]) -> Dataset:
    count, fps = _count(described["frames"]["count"], MOST_FRAMES), float(described["fps"])
    if not 0 < fps < 1e6:
        raise ValueError(f"fps is {fps}")
    truth = described["truth"]
    width, height = (_count(side, MAX_SIDE) for side in described["size"])
    source = [inside(folder, name) for name in _numbered(described["frames"]["pattern"], range(count))]
    return Dataset(
        name=str(described["recipe"]),
        path=folder,
        layout="vr",
        size=(width, height),
        fps=fps,
        source=source,
        times_s=even_times(count, fps),
        truth=Tracks.read(inside(folder, truth["tracks"])),
        camera=_camera(folder),
        cam_from_station=_poses(folder, described, count),
        objects=tuple(_object(one) for one in described["objects"]),
        flow_files=_files(folder, truth.get("flow"), count),
        flow_step=_count((truth.get("flow") or {}).get("step", 1), count),
        mask_files=_files(folder, truth.get("masks"), count),
        described=described,
    )


def _views(folder: Path, described: dict[str, Any]) -> Dataset:
    source = [inside(folder, view["image"]) for view in described["views"]]
    if not source:
        raise BadDataset(folder, "it has no views")
    return Dataset(
        name=str(described["recipe"]),
        path=folder,
        layout="vr",
        size=picture_size(source[0]),
        fps=1.0,
        source=source,
        times_s=even_times(len(source), 1.0),
        truth=Tracks.empty(),
        camera=_camera(folder),
        described=described,
    )


def _camera(folder: Path) -> Any:
    try:
        return read_camera(folder / "dataset.json")
    except BadCameraFile as error:
        raise BadDataset(folder / "dataset.json", error.why) from error


def _poses(folder: Path, described: dict[str, Any], count: int) -> SE3 | None:
    if "camera_motion" in described:
        path = inside(folder, described["camera_motion"])
        rows = [row for _, row in csv_rows(read_text(path, BadDataset, LARGEST_TABLE), path, BadDataset)]
        table = np.array(rows[1:], dtype=float)
        if table.shape != (count, 7) or not np.isfinite(table).all():
            raise BadDataset(path, f"it has not {count} rows of 7 numbers")
        return SE3.from_rotvec(table[:, 1:4], table[:, 4:7])
    if described.get("cam_from_station") is None:
        return None
    return read_pose(parse_json(open_source(folder / "dataset.json")).get("cam_from_station"))


def _object(one: dict[str, Any]) -> DatasetObject:
    rest = {key: value for key, value in one.items() if key not in ("id", "name")}
    return DatasetObject(int(one["id"]), str(one["name"]), rest)


def _files(folder: Path, where: dict[str, Any] | None, count: int) -> dict[int, Path]:
    if not where:
        return {}
    frames = range(count - int(where.get("step", 0)))
    return {
        i: inside(folder, name) for i, name in zip(frames, _numbered(where["pattern"], frames), strict=True)
    }


def _count(value: Any, most: int) -> int:
    """A whole number from 1 to `most`."""
    if not (isinstance(value, int) and 1 <= value <= most):
        raise ValueError(f"{value!r} is no whole number from 1 to {most}")
    return value


def _numbered(pattern: str, numbers: range) -> list[str]:
    """The names of numbered files; a pattern that leads out of the folder is refused."""
    if not PATTERN.fullmatch(pattern) or pattern.startswith("/") or ".." in pattern:
        raise ValueError(f"pattern {pattern!r}")
    return [pattern.format(number) for number in numbers]


LAYOUT = Layout("dataset.json", recognises, read)
