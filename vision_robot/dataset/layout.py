"""What a layout of datasets is to the choice among them."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from vision_robot.dataset.dataset import Dataset

__all__ = ["Layout"]


class Layout(NamedTuple):
    """How a layout is recognised and read."""

    mark: str
    """The file by which a person recognises it."""
    recognises: Callable[[Path], bool]
    read: Callable[[Path], Dataset]
