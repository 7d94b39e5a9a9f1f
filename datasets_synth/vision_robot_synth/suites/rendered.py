"""Rendered sets that many cells share: made by the first that needs one, found by the others."""

import fcntl
import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import vision_robot
from vision_robot.dataset import Dataset, open_dataset
from vision_robot_synth.making import synthesise
from vision_robot_synth.recipe import read_recipe

__all__ = ["rendered_set"]


def rendered_set(
    workspace: Path,
    recipe: str,
    *,
    severity: float,
    seed: int,
    frames: int | None = None,
    size: tuple[int, int] | None = None,
    flow: str | None = None,
) -> Dataset:
    """The dataset of a recipe, its name or a file, in `workspace`; rendered once, whoever asks first.

    `flow` is none, png or flo, else what the recipe says. One process renders while others that want the
    same set wait for it, and the system frees the lock of one that is killed.
    """
    read = read_recipe(recipe).with_video(frames=frames, size=size)
    if flow is not None:
        read = replace(read, tree={**read.tree, "truth": {**read.tree.get("truth", {}), "flow": flow}})
    content = repr((read, severity, seed, vision_robot.__version__))
    name = f"{read.name}-{severity:g}-{seed}-{hashlib.sha256(content.encode()).hexdigest()[:12]}"
    folder = workspace / "rendered" / name
    with _locked(folder.with_name(f"{name}.lock")):
        synthesise(read, folder, severity=severity, seed=seed)
    return open_dataset(folder)


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
