"""Folders of numbered pictures."""

import re
from pathlib import Path

from vision_robot.errors import BadDataset
from vision_robot.images import IMAGE_SUFFIXES, read_image

__all__ = ["inside", "numbered_pictures", "picture_size"]


def numbered_pictures(folder: Path, layout: str) -> list[Path]:
    """The pictures of a folder in the order of the numbers at the end of their names.

    Raises BadDataset where there are none or numbers are missing between the first and the last.
    """
    if not folder.is_dir():
        raise BadDataset(
            folder.parent, f"a {layout} sequence keeps its frames in {folder.name}/, which is not there"
        )
    numbered = {}
    for file in folder.iterdir():
        number = re.search(r"(\d+)$", file.stem)
        if number and file.suffix.lower() in IMAGE_SUFFIXES and not file.name.startswith("."):
            numbered[int(number[1])] = file
    if not numbered:
        raise BadDataset(folder, "it holds no numbered pictures")
    first, last = min(numbered), max(numbered)
    if last - first >= len(numbered):
        missing = next(number for number in range(first, last + 1) if number not in numbered)
        raise BadDataset(folder, f"frame {missing} of {first} to {last} is missing")
    return [numbered[number] for number in range(first, last + 1)]


def inside(folder: Path, name: str) -> Path:
    """What a dataset calls `name`. Raises BadDataset where that leads out of the folder, or is no name."""
    parts = Path(name).parts
    if Path(name).is_absolute() or ".." in parts or "\0" in name or any(len(part) > 250 for part in parts):
        raise BadDataset(folder, f"it names {name[:100]!r}, which is no place in it")
    return folder / name


def picture_size(path: Path) -> tuple[int, int]:
    """Width and height of a picture."""
    height, width = read_image(path).shape[:2]
    return width, height
