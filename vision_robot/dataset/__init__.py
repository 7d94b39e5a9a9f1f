"""A dataset on disk, ours or another's: frames, what is true in them, and the camera that saw them."""

from vision_robot.dataset.dataset import Dataset, DatasetObject
from vision_robot.dataset.flow_files import FlowField, read_flow, write_flow
from vision_robot.dataset.layouts import LAYOUTS, open_dataset
from vision_robot.dataset.sequences import sequences_in

__all__ = [
    "LAYOUTS",
    "Dataset",
    "DatasetObject",
    "FlowField",
    "open_dataset",
    "read_flow",
    "sequences_in",
    "write_flow",
]
