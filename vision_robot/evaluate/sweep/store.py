"""Results on disk, one small file a cell, under the hash of what it is a result of."""

import json
import math
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import vision_robot
from vision_robot.errors import BadParameter, BadTable
from vision_robot.evaluate.sweep.cell import Cell, Outcome
from vision_robot.files import write_text
from vision_robot.reading import json_tree, read_text

__all__ = ["Store"]

SCHEMA = "vr.outcome/1"


class Store:
    """A folder of outcomes. Files appear whole, so that several runs may share it and any may be killed."""

    def __init__(self, folder: Path | str):
        self.folder = Path(folder)

    @property
    def workspace(self) -> Path:
        """Where cells keep what several of them need."""
        return self.folder / "workspace"

    def other_versions(self) -> list[str]:
        """Versions of this library that have kept outcomes here, but this one, which is noted down.

        Their outcomes have other keys and are not found: methods may have changed.
        """
        place = self.folder / "versions.json"
        try:
            known = [str(one) for one in json.loads(place.read_text(encoding="utf-8"))]
        except (OSError, ValueError, TypeError):
            known = []
        if vision_robot.__version__ not in known:
            write_text(place, json.dumps([*known, vision_robot.__version__]) + "\n")
        return [one for one in known if one != vision_robot.__version__]

    def find(self, cell: Cell) -> Outcome | None:
        """The outcome of this very cell; None where there is none, or its file is damaged."""
        try:
            return _read(self._place(cell.key))
        except BadTable:
            return None

    def keep(self, outcome: Outcome) -> None:
        """Write an outcome. Raises UnwritableOutput."""
        figures = {
            name: value if math.isfinite(value) else repr(value) for name, value in outcome.figures.items()
        }
        content = {"schema": SCHEMA, **asdict(outcome), "figures": figures}
        write_text(self._place(outcome.cell.key), json.dumps(content, allow_nan=False) + "\n")

    def __iter__(self) -> Iterator[Outcome]:
        """All outcomes, in the order of their keys. Raises BadTable, naming it, for a file that is none."""
        for path in sorted(self.folder.glob("??/*.json")):
            yield _read(path)

    def _place(self, key: str) -> Path:
        return self.folder / key[:2] / f"{key}.json"


def _read(path: Path) -> Outcome:
    content = json_tree(read_text(path, BadTable), path, BadTable)
    try:
        return _outcome(content)
    except (ValueError, KeyError, TypeError, AttributeError, BadParameter) as error:
        raise BadTable(path, "it is no outcome of a sweep; remove it") from error


def _outcome(content: dict[str, Any]) -> Outcome:
    if content["schema"] != SCHEMA:
        raise ValueError(content["schema"])
    cell = Cell(**content["cell"])
    words = (cell.suite, cell.scene, cell.method, cell.work, content["failure"] or "", *content["figures"])
    if not all(isinstance(word, str) for word in words) or not isinstance(cell.seed, int):
        raise TypeError(f"words and a seed expected, {words} and {cell.seed} found")
    return Outcome(
        cell=cell,
        # What JSON has no number for stands there as a word: nan, inf.
        figures={name: float(value) for name, value in content["figures"].items()},
        failure=content["failure"],
        seconds=content["seconds"],
        peak_memory_bytes=content["peak_memory_bytes"],
        strip=content.get("strip"),
        machine=content.get("machine", ""),
        cpu_seconds=content.get("cpu_seconds"),
    )
