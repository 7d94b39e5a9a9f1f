"""The layouts that can be read, and the choice among them."""

from importlib import import_module
from pathlib import Path

from vision_robot.dataset.dataset import Dataset
from vision_robot.dataset.layout import Layout
from vision_robot.errors import BadDataset, BadParameter

__all__ = ["LAYOUTS", "open_dataset", "recognised"]

LAYOUTS: dict[str, str] = {
    "vr": "vision_robot.dataset.generated:LAYOUT",
    "mot": "vision_robot.dataset.mot:LAYOUT",
    "otb": "vision_robot.dataset.otb:LAYOUT",
    "middlebury": "vision_robot.dataset.middlebury:LAYOUT",
}
"""Name -> where the layout is; the order is the order of recognition."""


def open_dataset(path: Path | str, layout: str | None = None) -> Dataset:
    """The dataset in a folder; its layout is recognised unless it is given.

    Raises BadDataset where nothing is recognised, and what the layout's reader raises.
    """
    folder = Path(path)
    if layout is not None and layout not in LAYOUTS:
        raise BadParameter("layout", layout, f"one of {', '.join(LAYOUTS)}")
    if folder.name == "dataset.json":
        folder = folder.parent
    if not folder.is_dir():
        raise BadDataset(path, "there is no such folder")
    if layout:
        return _read(layout, folder)
    name = recognised(folder)
    if name is not None:
        return _read(name, folder)
    marks = ", ".join(f"{_layout(name).mark} ({name})" for name in LAYOUTS)
    raise BadDataset(path, f"none of these is in it: {marks}")


def recognised(folder: Path) -> str | None:
    """The layout a folder has, by the file that marks it."""
    return next((name for name in LAYOUTS if _layout(name).recognises(folder)), None)


def _read(name: str, folder: Path) -> Dataset:
    try:
        return _layout(name).read(folder)
    except OSError as error:  # such as names in its tables that are too long to be names
        raise BadDataset(folder, error.strerror or str(error)) from error


def _layout(name: str) -> Layout:
    module, attribute = LAYOUTS[name].split(":")
    return getattr(import_module(module), attribute)
