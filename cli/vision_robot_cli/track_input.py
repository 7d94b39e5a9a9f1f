"""What `vr track` is given: a tracker with its own options, a plane, limits of the following."""

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from vision_robot.errors import BadParameter
from vision_robot.geometry.work_plane import WorkPlane
from vision_robot.reading import LARGEST_OPTIONS, read_text, toml_tree
from vision_robot.track import Tracker, tracker_named
from vision_robot.track.registry import tracker_class, tracker_names

__all__ = ["plane_of", "tracker_of"]


def tracker_of(
    name: str,
    sets: Sequence[str],
    file: Path | None,
    *,
    color: Sequence[str] = (),
    pick: Sequence[str] = (),
    roi: Sequence[str] = (),
) -> Tracker:
    """The tracker of --tracker with the options of --config, then of --set, --color, --pick and --roi."""
    cls = tracker_class(name)
    known = [one.name for one in fields(cls.Options)]
    options = _from_file(file, name) if file else {}
    for word in sets:
        options |= _one(word, name, known)
    for option, values in (("color", color), ("pick", pick), ("roi", roi)):
        if values:
            if option not in known:
                raise BadParameter(
                    f"--{option}", ",".join(values), f"left out: tracker {name} knows no colours"
                )
            options[option] = ",".join(values)
    return tracker_named(name, options)


def plane_of(camera: Path | None, plane: Path | None) -> WorkPlane | None:
    """The work plane of --plane, whose file holds its camera, or seen by --camera of the same size."""
    from vision_robot.formats import read_camera
    from vision_robot.formats.work_plane import read_work_plane

    if plane is None:
        if camera is not None:
            raise BadParameter("--camera", str(camera), "given together with --plane")
        return None
    found = read_work_plane(plane)
    if camera is None:
        return found
    own = read_camera(camera)
    if (own.width, own.height) != (found.camera.width, found.camera.height):
        allowed = f"{found.camera.width}x{found.camera.height} px, as in {plane}"
        raise BadParameter("--camera", f"{own.width}x{own.height} px", allowed)
    if own.parameter_names != found.camera.parameter_names:
        return WorkPlane.exact(own, found.cam_from_station)
    return WorkPlane(own, found.cam_from_station, found.covariance)


def _one(word: str, tracker: str, known: Sequence[str]) -> dict[str, str]:
    """tracker.option=value, or option=value for the tracker that runs."""
    place, equals, value = word.partition("=")
    owner, dot, option = place.strip().rpartition(".")
    if not equals:
        raise BadParameter("--set", word, f"{tracker}.option=value with one of {', '.join(known)}")
    if dot and owner != tracker:
        if owner in tracker_names():
            raise BadParameter(
                "--set", word, f"an option of the tracker that runs, {tracker}: {', '.join(known)}"
            )
        raise BadParameter("--set", word, f"{tracker}.option=value with one of {', '.join(known)}")
    return {option: value.strip()}


def _bad_config(path: object, why: str) -> BadParameter:
    return BadParameter("--config", str(path), f"a readable TOML file ({why})")


def _from_file(path: Path, tracker: str) -> dict[str, Any]:
    """The table named like the tracker in a TOML file; tables of other trackers are left alone."""
    tables = toml_tree(read_text(path, _bad_config, LARGEST_OPTIONS), path, _bad_config)
    unknown = [
        name for name, table in tables.items() if name not in tracker_names() or not isinstance(table, dict)
    ]
    if unknown:
        named = f"tables named like trackers ({', '.join(tracker_names())})"
        raise BadParameter(f"--config {path}", ", ".join(unknown), named)
    return dict(tables.get(tracker, {}))
