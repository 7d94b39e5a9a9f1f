"""Drawings as SVG text: one style, the same bytes every time, fit to stand inside HTML."""

import re
from collections.abc import Callable
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["ACCENT", "FAINT", "INK", "WARM", "WIDTH_IN", "draw", "inline_svg", "segments", "view_colours"]

INK, FAINT, ACCENT, WARM = "#20262e", "#b4bcc6", "#1f5fa8", "#b8430a"
"""Text and frames, secondary lines, data, and what needs a look (contrast with white 5:1 or more)."""

WIDTH_IN = 4.8
"""Width of every drawing: at 72 units an inch its text is legible on a phone."""

_STYLE = {
    "svg.fonttype": "none",  # text stays text: it is small, can be searched and takes the page's font
    "svg.hashsalt": "vision-robot",  # else identifiers are random
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8.0,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.labelpad": 2.5,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.1,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.unicode_minus": True,
    "text.parse_math": False,
    "path.simplify": False,
}


def draw(paint: Callable[["Figure"], None], *, height_in: float, text_pt: float = 8.0) -> str:
    """SVG text of a drawing that `paint` puts on an empty figure of width `WIDTH_IN`.

    Titles and ticks follow `text_pt`, the size of ordinary text. No pyplot, no window, no date:
    the bytes follow from the data alone.
    """
    import io

    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    sizes = {key: value * text_pt / 8 for key, value in _STYLE.items() if key.endswith("size")}
    with matplotlib.rc_context({**_STYLE, **sizes}):  # pyright: ignore[reportArgumentType]
        figure = Figure(figsize=(WIDTH_IN, height_in))
        # Fixed margins: drawings side by side then line up, and no layout is solved for.
        figure.subplots_adjust(
            left=0.56 / WIDTH_IN, right=1 - 0.08 / WIDTH_IN, bottom=0.40 / height_in, top=1 - 0.08 / height_in
        )
        FigureCanvasSVG(figure)
        paint(figure)
        text = io.StringIO()
        figure.savefig(text, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    return text.getvalue()


def inline_svg(svg: str, *, alt: str, prefix: str) -> str:
    """An SVG document as an element of an HTML page.

    Leaves out the XML header, namespaces and metadata, which hold addresses and mean
    nothing inside HTML; names what it shows; gives identifiers a prefix, since all
    drawings of a page share one space of names; rounds coordinates to 0.01.
    """
    body = svg[svg.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    body = re.sub(r"<!--.*?-->", "", body, flags=re.DOTALL)
    body = re.sub(r'\s(xmlns(:\w+)?|version)="[^"]*"', "", body)
    body = body.replace("xlink:href", "href")
    used = set(re.findall(r'(?:href="#|url\(#)([^")]+)', body))

    def renamed(match: re.Match[str]) -> str:
        return f' id="{prefix}{match[1]}"' if match[1] in used else ""

    body = re.sub(r'\sid="([^"]*)"', renamed, body)
    body = re.sub(r'(href="#|url\(#)', rf"\g<1>{prefix}", body)
    body = re.sub(r"<[^>]+>", lambda tag: re.sub(r"-?\d+\.\d{3,}", _rounded, tag[0]), body)
    body = re.sub(r"font-family: [^;\"]*;? ?", "", body)
    body = re.sub(r' transform="rotate\(-?0 [^"]*"', "", body)
    opening = re.match(r"<svg[^>]*>", body)
    assert opening is not None
    view_box = re.search(r'viewBox="[^"]*"', opening[0])
    assert view_box is not None
    head = f'<svg {view_box[0]} role="img" aria-label="{escape(alt)}">'
    return re.sub(r">\s+<", "><", head + body[opening.end() :]).strip()


def segments(
    axes: "Axes",
    starts: Float[Array, "n 2"],
    ends: Float[Array, "n 2"] | None = None,
    *,
    colour: str,
    width: float,
    clip: bool = True,
) -> None:
    """Many lines as one path, or, without ends, many round dots of that width: a tenth of the bytes."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    n = len(starts)
    vertices = np.stack([starts, starts if ends is None else ends], axis=1).reshape(-1, 2)
    codes = np.tile([Path.MOVETO, Path.LINETO], n)
    patch = PathPatch(
        Path(vertices, codes), facecolor="none", edgecolor=colour, linewidth=width, capstyle="round"
    )
    patch.set_clip_on(clip)
    axes.add_patch(patch)


def view_colours(count: int) -> list[str]:
    """A colour for each view, along a wheel of equal lightness so that none is pale on white."""
    hue = np.arange(count) / max(count, 1) * 2 * np.pi
    # A circle in Oklab at L = 0.58 (Ottosson 2020), carried to sRGB.
    L, a, b = 0.58, 0.13 * np.cos(hue), 0.13 * np.sin(hue)
    lms = np.stack(
        [
            L + 0.3963377774 * a + 0.2158037573 * b,
            L - 0.1055613458 * a - 0.0638541728 * b,
            L - 0.0894841775 * a - 1.2914855480 * b,
        ]
    )
    to_rgb = np.array(
        [
            [4.0767416621, -3.3077115913, 0.2309699292],
            [-1.2684380046, 2.6097574011, -0.3413193965],
            [-0.0041960863, -0.7034186147, 1.7076147010],
        ]
    )
    linear = np.clip(to_rgb @ lms**3, 0, 1)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in np.round(255 * srgb.T).astype(int)]


def _rounded(match: re.Match[str]) -> str:
    return f"{float(match[0]):.2f}".rstrip("0").rstrip(".")
