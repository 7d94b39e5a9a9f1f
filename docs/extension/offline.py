"""Holds the built manual to need no network: whoever reads it on a machine beside a robot may have none."""

import re
from pathlib import Path
from typing import Any

from sphinx.errors import ExtensionError

ELSEWHERE = r'"(?:https?:)?//'
FETCHED = re.compile(rf"<(?:script|img|iframe|source)\b[^>]*\bsrc={ELSEWHERE}|<link\b[^>]*\bhref={ELSEWHERE}")


def check(app: Any, failure: Exception | None) -> None:
    """Called when Sphinx has built: raises where a page would fetch a script, style, font or picture."""
    if failure or app.builder.format != "html":
        return
    guilty = [
        str(page.relative_to(app.outdir))
        for page in Path(app.outdir).rglob("*.html")
        if FETCHED.search(page.read_text(encoding="utf-8"))
    ]
    if guilty:
        raise ExtensionError(f"these pages fetch something from the network: {', '.join(sorted(guilty))}")


def setup(app: Any) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("build-finished", check)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
