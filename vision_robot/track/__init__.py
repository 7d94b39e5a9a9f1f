"""Objects in videos from a fixed camera: where they are, how they lie, how they move.

A tracker answers each frame with `Blobs`; to add one, write one file with a `Tracker` and add its
line to `registry.TRACKERS`, or name it as an entry point of a package of your own.
"""

from vision_robot.track.blobs import Blobs
from vision_robot.track.registry import TRACKERS, tracker_named, tracker_names
from vision_robot.track.tracker import LooksAhead, Tracker

__all__ = ["TRACKERS", "Blobs", "LooksAhead", "Tracker", "tracker_named", "tracker_names"]
