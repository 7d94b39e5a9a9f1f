"""Other people's trackers behind our protocol, so that they run on the same frames and are scored alike."""

from vision_robot.evaluate.peers.registry import PEERS, peer_named

__all__ = ["PEERS", "peer_named"]
