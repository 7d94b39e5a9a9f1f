"""Writes the pages that come from the program itself, before Sphinx reads any."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .commands import command_pages
from .metrics import metrics_table
from .recipes import recipes_table
from .schemas import schema_pages

__all__ = ["write_pages"]


def write_pages(docs: Path) -> None:
    """All generated pages into the manual's folder."""
    _fill(docs / "reference/commands", command_pages())
    _fill(docs / "reference/json", schema_pages())
    _fill(docs / "reference/tables", {"metrics.md": metrics_table(), "recipes.md": recipes_table()})


def _fill(folder: Path, pages: Mapping[str, str]) -> None:
    """Exactly these pages; a file whose text stays keeps its time, so that it is not built again."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.glob("*.md"):
        if path.name not in pages:
            path.unlink()
    for name, text in pages.items():
        path = folder / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def setup(app: Any) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("builder-inited", lambda app: write_pages(Path(app.srcdir)))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
