"""Trackers by name: ours, and those that installed packages bring."""

from collections.abc import Mapping
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any

from vision_robot.errors import BadParameter, BrokenPlugin
from vision_robot.track.options import options_of
from vision_robot.track.tracker import Tracker

__all__ = ["ENTRY_POINTS", "TRACKERS", "tracker_class", "tracker_named", "tracker_names"]

TRACKERS: dict[str, str] = {
    "optical-flow": "vision_robot.track.optical_flow:OpticalFlow",
    "optical-flow-plain": "vision_robot.track.optical_flow_plain:OpticalFlowPlain",
    "rgb": "vision_robot.track.rgb:Rgb",
    "rgb-plain": "vision_robot.track.rgb_plain:RgbPlain",
    "background": "vision_robot.track.background:Background",
    "background-plain": "vision_robot.track.background_plain:BackgroundPlain",
}
"""Name -> where the tracker is. The plain ones are the text's own forms, kept to be compared with."""

ENTRY_POINTS = "vision_robot.trackers"
"""Group in which a package names its trackers: ``my-tracker = "my_package.my_tracker:MyTracker"``."""


def tracker_names() -> list[str]:
    """All names, ours first."""
    return [*TRACKERS, *(name for name in sorted(_plugins()) if name not in TRACKERS)]


def tracker_class(name: str) -> type[Tracker]:
    """The class of that name.

    Raises BadParameter for an unknown name, listing the known, and BrokenPlugin, naming
    package and cause, for one that cannot be imported or is no tracker.
    """
    if name in TRACKERS:
        module, attribute = TRACKERS[name].split(":")
        return getattr(import_module(module), attribute)
    plugins = _plugins()
    if name not in plugins:
        raise BadParameter("tracker", name, f"one of {', '.join(tracker_names())}")
    return _loaded(plugins[name])


def tracker_named(name: str, options: Mapping[str, Any] | None = None) -> Tracker:
    """A new tracker of that name with its own options; values may be texts, as typed.

    Raises as `tracker_class`, and BadParameter for an option it does not have or a value it cannot take.
    """
    cls = tracker_class(name)
    return cls(options_of(cls.Options, options or {}, name))


def _plugins() -> dict[str, Any]:
    """EntryPoints by name; where the back-port of importlib.metadata is installed they are its own."""
    return {entry.name: entry for entry in entry_points(group=ENTRY_POINTS)}


def _loaded(entry: Any) -> type[Tracker]:
    package = entry.dist.name if entry.dist else "an unnamed package"
    try:
        cls = entry.load()
    except Exception as error:
        why = f"{type(error).__name__}: {error}"
        raise BrokenPlugin(entry.name, package, entry.value, why) from error
    if not (isinstance(cls, type) and issubclass(cls, Tracker)):
        raise BrokenPlugin(entry.name, package, entry.value, "it is no vision_robot.track.Tracker")
    return cls
