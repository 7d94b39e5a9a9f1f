"""All labelled videos below a folder, as published sets hand them out."""

import hashlib
from pathlib import Path

from vision_robot.dataset.dataset import Dataset
from vision_robot.dataset.layouts import open_dataset, recognised
from vision_robot.errors import BadDataset
from vision_robot.video import Video

__all__ = ["fingerprint", "sequences_in"]

DEEPEST = 3


def sequences_in(path: Path | str) -> dict[str, Dataset]:
    """The datasets in a folder or in those below it, by their paths in it, in order.

    A folder that is a dataset itself is the only one, by its own name. Raises BadDataset where there is none,
    and what a layout's reader raises for one that is damaged.
    """
    folder = Path(path)
    if not folder.is_dir():
        raise BadDataset(path, "there is no such folder")
    if recognised(folder):
        return {folder.absolute().name: open_dataset(folder)}
    found = {str(place.relative_to(folder)): open_dataset(place) for place in _below(folder, DEEPEST)}
    if not found:
        open_dataset(folder)  # says what it would have known one by
    return found


def fingerprint(data: Dataset) -> str:
    """Changes when a file of frames or truth does: frames and masks by name, size and time."""
    source = [Path(data.source.path)] if isinstance(data.source, Video) else list(data.source)
    told = hashlib.sha256()
    for file in [*source, *data.flow_files.values(), *data.mask_files.values()]:
        if file.exists():
            state = file.stat()
            told.update(f"{file.name} {state.st_size} {state.st_mtime_ns}\n".encode())
    for table in (data.truth, data.ignored):
        for column in (table.frame, table.id, table.centroid_px, table.box_px):
            told.update(column.tobytes())
    return told.hexdigest()[:16]


def _below(folder: Path, depth: int) -> list[Path]:
    found = []
    for place in sorted(one for one in folder.iterdir() if one.is_dir()):
        if recognised(place):
            found.append(place)
        elif depth > 1:
            found += _below(place, depth - 1)
    return found
