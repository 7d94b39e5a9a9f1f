"""A dataset from a recipe, whole or not at all, and resumed where a run was cut short."""

import hashlib
import json
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

from vision_robot.errors import BadParameter, UnwritableOutput
from vision_robot.files import write_text
from vision_robot_synth.making.described import described
from vision_robot_synth.making.frame_files import FRAME, Workshop
from vision_robot_synth.making.readme import readme_text
from vision_robot_synth.making.tables import camera_table, coco_text, mot_table, sequence_file, tracks_of
from vision_robot_synth.making.workers import make_frames
from vision_robot_synth.recipe import Recipe
from vision_robot_synth.scene.scene import Scene, scene_of

__all__ = ["Made", "synthesise"]


@dataclass(frozen=True)
class Made:
    """What was made, and how fast."""

    folder: Path
    described: dict[str, Any]
    frames: int
    rendered: int
    """Frames made in this run; the others were there from one before."""
    seconds: float


def synthesise(
    recipe: Recipe,
    folder: Path | str,
    *,
    severity: float = 0.5,
    seed: int = 0,
    workers: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> Made:
    """Make a dataset of a video recipe in `folder`, which appears complete or not at all.

    Frames gather in a hidden folder beside it, where a killed run goes on; the same recipe, severity
    and seed give the same bytes on the same machine, however often the run was cut short and
    on however many workers. A folder that already holds this dataset is left as it is.
    Raises UnwritableOutput where anything else is in the way, BadRecipe, BadParameter and MissingOpenGL.
    """
    start, folder = perf_counter(), Path(folder)
    if seed < 0:
        raise BadParameter("seed", seed, "zero or a positive whole number")
    if not 1 <= workers <= 256:
        raise BadParameter("workers", workers, "from 1 to 256")
    if recipe.video.kind != "video":
        raise BadParameter("kind of recipe", recipe.video.kind, "video")
    scene = scene_of(recipe.at(severity), seed)
    facts = described(scene, severity)
    text = json.dumps(facts, indent=1, allow_nan=False) + "\n"
    workshop = Workshop.for_dataset(folder, hashlib.sha256(text.encode()).hexdigest()[:16])
    count = recipe.video.frames
    done = folder / "dataset.json"
    if done.is_file() and done.read_text(encoding="utf-8") == text:
        workshop.clear_notes()
        return Made(folder, facts, count, 0, perf_counter() - start)
    if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
        raise UnwritableOutput(folder, "it exists and holds something else")
    try:
        workshop.folder.mkdir(parents=True, exist_ok=True)
        left = workshop.missing(count)
        for made, _ in enumerate(make_frames(scene, workshop, left, workers), start=1):
            if progress is not None:
                progress(count - len(left) + made, count)
        _write_tables(scene, facts, workshop)
        write_text(workshop.folder / "dataset.json", text)
        # Renaming onto an empty folder is allowed, onto a full one it fails.
        os.replace(workshop.folder, folder)  # noqa: PTH105
    except OSError as error:
        raise UnwritableOutput(folder, error.strerror or str(error)) from error
    workshop.clear_notes()
    return Made(folder, facts, count, len(left), perf_counter() - start)


def _write_tables(scene: Scene, facts: dict[str, Any], workshop: Workshop) -> None:
    folder, count = workshop.folder, scene.recipe.video.frames
    for temporary in folder.rglob(".*"):  # of a run that was killed while it wrote
        temporary.unlink()
    for frame in range(count):
        delivered = scene.sensor.delivered(frame, scene.seed)
        if delivered != frame:
            shutil.copyfile(folder / FRAME.format(delivered), folder / FRAME.format(frame))
    notes = [workshop.note(frame) for frame in range(count)]
    tracks = tracks_of(scene, notes)
    tracks.write(folder / "truth/tracks.csv")
    write_text(folder / "gt/gt.txt", mot_table(tracks))
    write_text(folder / "seqinfo.ini", sequence_file(scene))
    if scene.shake:
        write_text(folder / "truth/camera.csv", camera_table(scene))
    if scene.recipe.truth.coco:
        write_text(folder / "truth/masks.json", coco_text(scene, notes))
    write_text(folder / "README.md", readme_text(facts))
