"""Peers by name."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from vision_robot.errors import BadParameter
from vision_robot.track.options import options_of
from vision_robot.track.tracker import Tracker

__all__ = ["PEERS", "peer_class", "peer_named"]

PEERS: dict[str, str] = {
    "cv2-mog2": "vision_robot.evaluate.peers.subtractors:Mog2",
    "cv2-knn": "vision_robot.evaluate.peers.subtractors:Knn",
    "cv2-cnt": "vision_robot.evaluate.peers.subtractors:Cnt",
    "cv2-gmg": "vision_robot.evaluate.peers.subtractors:Gmg",
    "cv2-gsoc": "vision_robot.evaluate.peers.subtractors:Gsoc",
    "cv2-lsbp": "vision_robot.evaluate.peers.subtractors:Lsbp",
    "cv2-farneback": "vision_robot.evaluate.peers.flow_blobs:FarnebackBlobs",
    "cv2-dis": "vision_robot.evaluate.peers.flow_blobs:DisBlobs",
    "cv2-csrt": "vision_robot.evaluate.peers.one_object:Csrt",
    "cv2-kcf": "vision_robot.evaluate.peers.one_object:Kcf",
    "cv2-mil": "vision_robot.evaluate.peers.one_object:Mil",
    "cv2-camshift": "vision_robot.evaluate.peers.camshift:CamShift",
}
"""Name -> where the adapter is. Those of one object are shown its true first box, as is their custom."""


def peer_class(name: str) -> type[Tracker]:
    """The adapter of that name. Raises BadParameter for an unknown name, listing the known."""
    if name not in PEERS:
        raise BadParameter("peer", name, f"one of {', '.join(PEERS)}")
    module, attribute = PEERS[name].split(":")
    return getattr(import_module(module), attribute)


def peer_named(name: str, options: Mapping[str, Any] | None = None) -> Tracker:
    """A new peer with its own options. Raises as `peer_class`, and BadParameter for options it lacks."""
    cls = peer_class(name)
    return cls(options_of(cls.Options, options or {}, name))
