"""What is printed under a target: its description, and a bar to hold a ruler against."""

from vision_robot.calibrate.boards.drawing import Polygon, TextLine

__all__ = ["legend"]

BAR_LENGTHS_MM = (1000, 500, 200, 100, 50, 20, 10, 5, 2, 1)
CHARACTER_WIDTH = 0.95
"""Mean width of a character in heights of a capital, on the safe side."""


def legend(
    description: str, *, left: float, top: float, width: float, margin: float
) -> tuple[tuple[Polygon, ...], tuple[TextLine, ...]]:
    """Scale bar and text for the quiet margin below a target.

    The margin begins at `top` and is `margin` high; the legend keeps within `left` and `width` [m].
    The bar is the longest of 1, 2, 5, … mm that takes at most half of the width; its outer ends
    are the two ends of the stated length. Everything stays in the middle of the margin, clear of the
    target and of what a printer cuts off.
    """
    length_mm = next((mm for mm in BAR_LENGTHS_MM if mm / 1000 <= width / 2), None)
    bar_text = f"{length_mm} mm" if length_mm else ""
    line = f"{description}, print at 100 %"
    bar_width = length_mm / 1000 if length_mm else 0.0
    # Description left, bar and its length right of it; shrink the print until all fits.
    room = (width - bar_width) / ((len(line) + len(bar_text) + 3) * CHARACTER_WIDTH)
    height = min(0.004, 0.12 * margin, room)
    base = top + 0.42 * margin + height / 2
    texts = [TextLine(line, left, base, height)]
    shapes: list[Polygon] = []
    if length_mm:
        start = left + width - bar_width
        thick, tick = height / 4, height
        shapes = [
            Polygon.rectangle(start, base - tick, thick, tick),
            Polygon.rectangle(start + bar_width - thick, base - tick, thick, tick),
            Polygon.rectangle(start + thick, base - (tick + thick) / 2, bar_width - 2 * thick, thick),
        ]
        text_width = (len(bar_text) + 1) * CHARACTER_WIDTH * height
        texts.append(TextLine(bar_text, start - text_width, base, height))
    return tuple(shapes), tuple(texts)
