"""What `vr synth` makes and says."""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

from vision_robot.dataset import open_dataset
from vision_robot_cli.output import note
from vision_robot_synth.making import Made, synthesise
from vision_robot_synth.recipe import Recipe, read_recipe, recipe_names

__all__ = ["add_films", "as_json", "as_table", "as_text", "keys", "make", "recipes"]


def make(
    recipe: Recipe,
    folder: Path,
    severity: float,
    seed: int,
    workers: int,
    tick: Callable[[int, int], None],
) -> Made:
    """The dataset of a recipe, of either kind."""
    if recipe.video.kind == "video":
        return synthesise(recipe, folder, severity=severity, seed=seed, workers=workers, progress=tick)
    from vision_robot_synth.calibration_folder import write_calibration_set
    from vision_robot_synth.views import views_of

    start = perf_counter()
    views = views_of(recipe, severity=severity, seed=seed)
    write_calibration_set(views, folder)
    described = {
        "recipe": recipe.name,
        "severity": severity,
        "seed": seed,
        "size": recipe.video.size,
        "objects": [],
    }
    return Made(folder, described, len(views), len(views), perf_counter() - start)


def add_films(folder: Path, *, preview: bool, mp4: bool) -> list[Path]:
    """Contact sheet and film, or a film to be played anywhere, made from the dataset on disk."""
    from vision_robot_synth.preview import write_film, write_preview

    added = []
    dataset = open_dataset(folder) if preview or mp4 else None
    if dataset and preview:
        added += write_preview(dataset, folder)
    if dataset and mp4:
        added.append(folder / "video.mp4")
        write_film(dataset, added[-1], width_px=dataset.size[0], whole=True)
    return added


def as_text(made: Made, extra: list[Path]) -> str:
    """Where it is, and what is in it."""
    width, height = made.described["size"]
    objects = ", ".join(one["name"] for one in made.described["objects"]) or "none"
    if made.rendered:
        rate = made.rendered / made.seconds
        note(f"{made.rendered} of {made.frames} frames rendered in {made.seconds:.1f} s, {rate:.1f} a second")
    else:
        note("all of it was there already")
    lines = [
        f"{made.folder}: {made.frames} frames of {width} x {height} px, objects: {objects}",
        *(str(path) for path in extra),
    ]
    return "\n".join(lines)


def as_json(made: Made, workers: int, extra: list[Path]) -> dict[str, Any]:
    """The object of --json."""
    return {
        "recipe": made.described["recipe"],
        "severity": made.described["severity"],
        "seed": made.described["seed"],
        "out": str(made.folder),
        "frames": made.frames,
        "size": made.described["size"],
        "objects": made.described["objects"],
        "rendered": made.rendered,
        "workers": workers,
        "seconds": made.seconds,
        "frames_per_s": made.rendered / made.seconds,
        "films": [str(path) for path in extra],
    }


def recipes() -> dict[str, Any]:
    """What --list shows."""
    found = [read_recipe(name) for name in recipe_names()]
    return {
        "recipes": [
            {"name": one.name, "description": one.video.description, "severity_turns": list(one.dial)}
            for one in found
        ]
    }


def keys() -> dict[str, Any]:
    """What --keys shows."""
    from vision_robot_synth.recipe.parts import PARTS, ThingPart, VideoPart, keys_of
    from vision_robot_synth.recipe.sensor_keys import SENSOR_KEYS

    tables = {"": keys_of(VideoPart), **{name: keys_of(part) for name, part in PARTS.items()}}
    tables = {**tables, "things.NAME": keys_of(ThingPart), "sensor": SENSOR_KEYS}
    return {
        "keys": [
            {"name": f"{table}.{name}" if table else name, "description": key.text,
             "default": key.default, "allowed": key.kind.allowed}
            for table, names in tables.items()
            for name, key in names.items()
        ]
    }  # fmt: skip


def as_table(table: dict[str, Any]) -> str:
    """Name and what it is for, a line each."""
    (rows,) = table.values()
    width = max(len(row["name"]) for row in rows)
    lines = []
    for row in rows:
        more = f" [{row['allowed']}; default {row['default']}]" if "allowed" in row else ""
        lines.append(f"{row['name']:<{width}}  {row['description']}{more}")
    return "\n".join(lines)
