"""A page: one HTML file that needs nothing but itself.

What it holds is plain data and is escaped when it is written, so a picture called
``<script>`` stays a name. Figures are inline SVG, made by `vision_robot.report.figure`.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from vision_robot.errors import BadParameter
from vision_robot.files import write_text

__all__ = [
    "Facts",
    "Figure",
    "Figures",
    "Footer",
    "Gallery",
    "Page",
    "Paragraph",
    "Part",
    "Picture",
    "Remarks",
    "Section",
    "Strips",
    "Table",
    "render_page",
    "write_page",
]

NO_BREAK_SPACE = "\u00a0"

FIGURE_SPACE, PUNCTUATION_SPACE = "\u2007", "\u2008"
"""As wide as a digit and as a full stop: they align decimals in a column set flush right."""


@dataclass(frozen=True)
class Paragraph:
    """Running text."""

    text: str


@dataclass(frozen=True)
class Remarks:
    """Sentences of advice, each (tone, text) with tone good, note or caution."""

    items: tuple[tuple[str, str], ...]

    def __post_init__(self) -> None:
        for tone, _ in self.items:
            if tone not in ("good", "note", "caution"):
                raise BadParameter("tone of a remark", tone, "good, note or caution")


@dataclass(frozen=True)
class Facts:
    """Headline numbers, each (name, value, what to know about it)."""

    items: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class Table:
    """Rows of texts under column titles; `numeric` columns are aligned on the decimal point."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str
    numeric: frozenset[int] = frozenset()
    pinned: bool = False
    """Whether the first column stays in sight where the table is wider than the page."""

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise BadParameter("cells of a table row", len(row), f"{len(self.columns)}, one a column")

    @property
    def aligned_rows(self) -> list[tuple[str, ...]]:
        """Rows whose numbers are padded to the same number of decimals."""
        columns = [[row[i] for row in self.rows] for i in range(len(self.columns))]
        padded = [_aligned(column) if i in self.numeric else column for i, column in enumerate(columns)]
        return list(zip(*padded, strict=True))


@dataclass(frozen=True)
class Figure:
    """An SVG drawing, what it shows for those who cannot see it, and its caption."""

    svg: str
    alt: str
    caption: str


@dataclass(frozen=True)
class Figures:
    """Figures set side by side where there is room."""

    items: tuple[Figure, ...]


@dataclass(frozen=True)
class Picture:
    """A small photograph as a data URI."""

    data_uri: str
    alt: str
    caption: str

    def __post_init__(self) -> None:
        if not self.data_uri.startswith("data:image/"):
            raise BadParameter("picture", self.data_uri[:40], "a data:image/... URI: a page fetches nothing")


@dataclass(frozen=True)
class Gallery:
    """Small pictures in rows; `wide` ones are twice as large, so that words in them can be read."""

    items: tuple[Picture, ...]
    wide: bool = False


@dataclass(frozen=True)
class Strips:
    """Wide pictures, each in a line of its own that can be moved sideways."""

    items: tuple[Picture, ...]


Part = Paragraph | Remarks | Facts | Table | Figures | Gallery | Strips


@dataclass(frozen=True)
class Section:
    """A titled run of parts."""

    title: str
    parts: tuple[Part, ...]


@dataclass(frozen=True)
class Footer:
    """How the page was made: program versions as (name, version), seed, command line."""

    versions: tuple[tuple[str, str], ...]
    seed: int | None = None
    command: str = ""


@dataclass(frozen=True)
class Page:
    """A whole report."""

    title: str
    summary: str
    sections: tuple[Section, ...]
    footer: Footer


def render_page(page: Page) -> str:
    """The page as one HTML text; the same page always gives the same text."""
    from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
    from markupsafe import Markup

    from vision_robot.report.figure import inline_svg

    environment = Environment(
        loader=PackageLoader("vision_robot.report", "."),
        autoescape=select_autoescape(default=True, default_for_string=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["inline"] = lambda figure, number: Markup(
        inline_svg(figure.svg, alt=figure.alt, prefix=f"f{number}-")
    )
    environment.filters["tied"] = _tied
    environment.tests["part"] = lambda part, kind: type(part).__name__ == kind
    return environment.get_template("page.html.j2").render(page=page)


def write_page(page: Page, path: Path | str) -> None:
    """Write the page, whole or not at all; raises UnwritableOutput."""
    write_text(path, render_page(page))


def _tied(text: str) -> str:
    """A number keeps its unit on its line."""
    return re.sub(r"(?<=\d) (?=(px|mm|mrad|%|σ|times|sigma)(?!\w))|(?<=±) | (?=±)", NO_BREAK_SPACE, text)


def _aligned(column: Sequence[str]) -> list[str]:
    decimals = [len(cell.partition(".")[2]) if "." in cell else -1 for cell in column]
    most = max(decimals, default=-1)
    return [
        cell + ("" if own >= 0 or most < 0 else PUNCTUATION_SPACE) + FIGURE_SPACE * (most - max(own, 0))
        for cell, own in zip(column, decimals, strict=True)
    ]
