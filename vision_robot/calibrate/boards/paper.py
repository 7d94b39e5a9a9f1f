"""Sheets of paper, and drawings in the middle of them."""

from vision_robot.calibrate.boards.drawing import Drawing
from vision_robot.errors import BadParameter

__all__ = ["PAGES_MM", "PRINTER_MARGIN_M", "on_page"]

PAGES_MM: dict[str, tuple[float, float]] = {
    "a5": (148, 210),
    "a4": (210, 297),
    "letter": (215.9, 279.4),
    "legal": (215.9, 355.6),
    "tabloid": (279.4, 431.8),
    "a3": (297, 420),
    "a2": (420, 594),
    "a1": (594, 841),
    "a0": (841, 1189),
}
"""Width and height of upright pages [mm], by rising size."""

PRINTER_MARGIN_M = 0.005
"""Rim of a sheet on which printers do not print."""

UNASKED = ("a4", "a3", "a2", "a1", "a0")


def on_page(drawing: Drawing, page: str | None = None) -> tuple[Drawing, str]:
    """The drawing's ink in the middle of a page, upright or on its side, and the page's name.

    Without `page`, the smallest of a4 … a0 that holds it. The white margin may run over the sheet's edge:
    paper is white. Raises BadParameter for unknown pages, and for pages too small, naming one that fits.
    """
    if page is not None and page.lower() not in PAGES_MM:
        raise BadParameter("page", page, f"one of {', '.join(PAGES_MM)}")
    left, top, right, bottom = drawing.ink_bounds
    width, height = right - left, bottom - top
    fitting = [name for name in (*UNASKED, *PAGES_MM) if _sheet(name, width, height)]
    name = page.lower() if page else next(iter(fitting), None)
    sheet = _sheet(name, width, height) if name else None
    if name is None or sheet is None:
        # Who has letter paper is helped more by legal than by a3.
        fitting.sort(key=lambda other: other.startswith("a") != (page or "a4").lower().startswith("a"))
        ink = f"{1000 * width:.0f} x {1000 * height:.0f} mm"
        way = f"at least {fitting[0]}" if fitting else "larger than a0: use smaller squares or an SVG"
        raise BadParameter("page", page or "a0", f"{way} for a print of {ink}")
    dx, dy = (sheet[0] - width) / 2 - left, (sheet[1] - height) / 2 - top
    return drawing.moved(dx, dy, page=sheet), name


def _sheet(name: str, width: float, height: float) -> tuple[float, float] | None:
    """Size [m] of the page, turned like the print, or None where this does not fit."""
    short, long = (side / 1000 for side in PAGES_MM[name])
    sheet = (long, short) if width > height else (short, long)
    room = 2 * PRINTER_MARGIN_M - 1e-9
    return sheet if width + room <= sheet[0] and height + room <= sheet[1] else None
