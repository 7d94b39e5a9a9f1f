"""The layout of Middlebury's optical flow: frame07.png ... frame14.png and flow10.flo.

Frames and flow lie in one folder, or, as they are handed out, in other-data/NAME and
other-gt-flow/NAME (other-gray-... as well) beside each other.
"""

import re
from pathlib import Path

from vision_robot.dataset.dataset import Dataset, even_times
from vision_robot.dataset.flow_files import read_flow
from vision_robot.dataset.folder import numbered_pictures, picture_size
from vision_robot.dataset.layout import Layout
from vision_robot.errors import BadDataset
from vision_robot.tracks import Tracks

__all__ = ["LAYOUT"]

FPS = 30.0
"""The layout keeps no rate."""


def recognises(folder: Path) -> bool:
    """A folder of frames."""
    return any(folder.glob("frame*.png"))


def read(folder: Path) -> Dataset:
    """A Middlebury sequence as a dataset without objects; sequences without true flow have none here."""
    source = numbered_pictures(folder, "Middlebury")
    first = int(re.findall(r"\d+", source[0].stem)[-1])
    size = picture_size(source[0])
    flow_files = {}
    for path in [*folder.glob("flow*.flo"), *_flow_folder(folder).glob("flow*.flo")]:
        number = re.search(r"(\d+)$", path.stem)
        if number is None or not 0 <= int(number[1]) - first < len(source) - 1:
            raise BadDataset(path, "there is no pair of frames of its number")
        flow = read_flow(path).flow_px
        if flow.shape[1::-1] != size:
            raise BadDataset(
                path, f"it is {flow.shape[1]}x{flow.shape[0]} px, the frames {size[0]}x{size[1]} px"
            )
        flow_files[int(number[1]) - first] = path
    return Dataset(
        name=folder.name,
        path=folder,
        layout="middlebury",
        size=size,
        fps=FPS,
        source=source,
        times_s=even_times(len(source), FPS),
        truth=Tracks.empty(),
        flow_files=flow_files,
    )


def _flow_folder(folder: Path) -> Path:
    """other-gt-flow/NAME for other-data/NAME, other-data-gray/NAME or other-color-allframes/NAME."""
    kind = folder.absolute().parent.name.split("-")[0]
    return folder.absolute().parent.parent / f"{kind}-gt-flow" / folder.absolute().name


LAYOUT = Layout("frame*.png", recognises, read)
