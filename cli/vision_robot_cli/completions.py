"""What the shell may complete as the value of an option: names from the registries.

Each function imports its registry when the shell asks, so that commands stay quick to build.
"""

from collections.abc import Iterable

__all__ = ["arms", "boards", "camera_formats", "models", "recipes", "schemas", "trackers"]


def boards(incomplete: str) -> list[str]:
    """Targets."""
    from vision_robot.calibrate.boards import BOARDS

    return _beginning(incomplete, BOARDS)


def models(incomplete: str) -> list[str]:
    """Lens models."""
    from vision_robot.geometry import LENSES

    return _beginning(incomplete, [*LENSES, "auto"])


def camera_formats(incomplete: str) -> list[str]:
    """Formats of camera files."""
    from vision_robot.formats import FORMATS

    return _beginning(incomplete, FORMATS)


def trackers(incomplete: str) -> list[str]:
    """Trackers, those of other packages included."""
    from vision_robot.track.registry import tracker_names

    return _beginning(incomplete, tracker_names())


def recipes(incomplete: str) -> list[str]:
    """Recipes of datasets."""
    from vision_robot_synth.recipe import recipe_names

    return _beginning(incomplete, recipe_names())


def schemas(incomplete: str) -> list[str]:
    """Schemas of `--json`."""
    from vision_robot_cli.schemas import schema_names

    return _beginning(incomplete, schema_names())


def arms(incomplete: str) -> list[str]:
    """The arm that comes with the tool; others are files, which the shell completes itself."""
    return _beginning(incomplete, ["column"])


def _beginning(incomplete: str, names: Iterable[str]) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]
