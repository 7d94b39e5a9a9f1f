"""Rendered sets that many cells share: made by the first that needs one, found by the others."""

import fcntl
import hashlib
import json
import shutil
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import vision_robot
from vision_robot.dataset import Dataset, open_dataset
from vision_robot_synth.making import synthesise
from vision_robot_synth.recipe import Recipe, read_recipe

__all__ = ["Tidying", "rendered_set"]


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
    read = _recipe(recipe, frames, size, flow)
    folder = _place(workspace, read, severity, seed)
    with _locked(folder):
        synthesise(read, folder, severity=severity, seed=seed)
    return open_dataset(folder)


class Tidying:
    """Removes rendered sets when the last cell that uses them is done: a long run would fill the disk."""

    def __init__(self, workspace: Path, used_by: Mapping[str, Mapping[str, Any] | None]):
        """`used_by`: key of each cell that is to be measured -> what it asks `rendered_set` for, or None."""
        self._workspace, self._used_by = workspace, used_by
        self._left = Counter(_key(told) for told in used_by.values() if told is not None)

    def done(self, key: str) -> None:
        """One cell less."""
        told = self._used_by.get(key)
        if told is None:
            return
        name = _key(told)
        self._left[name] -= 1
        if self._left[name] > 0:
            return
        video = dict(told)
        recipe, severity, seed = (video.pop(one) for one in ("recipe", "severity", "seed"))
        size = tuple(video["size"]) if video.get("size") else None
        read = _recipe(recipe, video.get("frames"), size, video.get("flow"))
        folder = _place(self._workspace, read, severity, seed)
        with _locked(folder):
            shutil.rmtree(folder, ignore_errors=True)


def _key(told: Mapping[str, Any]) -> str:
    return json.dumps(told, sort_keys=True)


def _recipe(name: str, frames: int | None, size: tuple[int, int] | None, flow: str | None) -> Recipe:
    read = read_recipe(name).with_video(frames=frames, size=size)
    if flow is None:
        return read
    return replace(read, tree={**read.tree, "truth": {**read.tree.get("truth", {}), "flow": flow}})


def _place(workspace: Path, read: Recipe, severity: float, seed: int) -> Path:
    content = repr((read, severity, seed, vision_robot.__version__))
    name = f"{read.name}-{severity:g}-{seed}-{hashlib.sha256(content.encode()).hexdigest()[:12]}"
    return workspace / "rendered" / name


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    path = folder.with_name(f"{folder.name}.lock")
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
