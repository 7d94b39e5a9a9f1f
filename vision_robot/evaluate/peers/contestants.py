"""Whoever takes part in a comparison of trackers, ours and others, shown what it must be shown."""

from collections.abc import Mapping
from typing import Any

from vision_robot.errors import BadParameter
from vision_robot.evaluate.peers.each import Each, EachOptions
from vision_robot.evaluate.peers.registry import PEERS, peer_class, peer_named
from vision_robot.evaluate.tracking.examples import Examples
from vision_robot.track.registry import tracker_class, tracker_named, tracker_names
from vision_robot.track.tracker import Tracker

__all__ = ["contestant", "contestant_class", "contestant_names"]

ONE_THING = ("rgb-plain",)
"""Trackers that know one thing only: they are shown the largest."""


def contestant_names() -> list[str]:
    """All names: ours, those of installed packages, peers."""
    return [*tracker_names(), *PEERS]


def contestant_class(name: str) -> type[Tracker]:
    """The class of that name. Raises BadParameter for an unknown one, listing the known."""
    if name in PEERS:
        return peer_class(name)
    if name not in tracker_names():
        raise BadParameter("tracker", name, f"one of {', '.join(contestant_names())}")
    return tracker_class(name)


def contestant(name: str, shown: Examples, options: Mapping[str, Any] | None = None) -> Tracker:
    """A new tracker with options of its own, shown what it asks for.

    Who takes points is shown one of each colour, as a person with a colour picker would; who takes a box gets
    the true box of each object, one tracker an object, as is the custom with those; the others find by
    themselves.
    """
    known, options = contestant_class(name).Options.__dataclass_fields__, dict(options or {})
    if "pick" in known:
        points = shown.points_px[:1] if name in ONE_THING else shown.points_px
        return tracker_named(name, {"pick": tuple(points.ravel().tolist()), **options})
    if "box_px" in known:
        boxes = [tuple(box.tolist()) for box in shown.boxes_px]
        return Each(EachOptions([peer_named(name, {"box_px": box, **options}) for box in boxes]))
    return peer_named(name, options) if name in PEERS else tracker_named(name, options)
