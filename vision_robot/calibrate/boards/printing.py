"""Drawings as files to print: PDF and SVG to scale, PNG with its resolution inside."""

import io
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from xml.sax.saxutils import escape

import cv2

from vision_robot.calibrate.boards.drawing import Disc, Drawing, Polygon, TextLine
from vision_robot.calibrate.boards.raster import raster
from vision_robot.errors import BadParameter
from vision_robot.files import write_bytes

__all__ = ["FORMATS", "pdf", "png", "print_drawing", "svg"]

CAPITAL_HEIGHT = 0.718
"""Height of Helvetica's capitals over its font size."""

POINTS_PER_METRE = 72 / 0.0254


def print_drawing(drawing: Drawing, path: Path | str, *, dpi: float = 600) -> None:
    """Write the drawing to `path`; the suffix chooses the format, `dpi` counts for PNG only.

    Raises BadParameter for other suffixes and UnwritableOutput.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        raise BadParameter("output file", str(path), f"named *{', *'.join(FORMATS)}")
    write_bytes(path, FORMATS[suffix](drawing, dpi))


def svg(drawing: Drawing) -> bytes:
    """Scalable vector graphics; the user unit is the millimetre."""
    width, height = _mm(drawing.width), _mm(drawing.height)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" '
        f'viewBox="0 0 {width} {height}">',
        f'<rect width="{width}" height="{height}" fill="#fff"/>',
        *(_svg_shape(shape) for shape in drawing.shapes),
        *(_svg_text(line) for line in drawing.texts),
        "</svg>",
    ]
    return ("\n".join(lines) + "\n").encode()


def pdf(drawing: Drawing) -> bytes:
    """One page of exactly the drawing's size; the same drawing gives the same bytes."""
    from reportlab.pdfgen.canvas import Canvas

    def points(length: float) -> float:
        return length * POINTS_PER_METRE

    file = io.BytesIO()
    page = Canvas(file, pagesize=(points(drawing.width), points(drawing.height)), invariant=1)
    page.setTitle(drawing.texts[0].text if drawing.texts else "calibration target")
    for shape in drawing.shapes:
        page.setFillGray(0 if shape.black else 1)
        if isinstance(shape, Disc):
            x, y = shape.centre
            page.circle(points(x), points(drawing.height - y), points(shape.radius), stroke=0, fill=1)
            continue
        outline = page.beginPath()
        for i, (x, y) in enumerate(shape.vertices):
            (outline.lineTo if i else outline.moveTo)(points(x), points(drawing.height - y))
        outline.close()
        page.drawPath(outline, stroke=0, fill=1)
    page.setFillGray(0)
    for line in drawing.texts:
        page.setFont("Helvetica", points(line.height) / CAPITAL_HEIGHT)
        page.drawString(points(line.left), points(drawing.height - line.base), line.text)
    page.showPage()
    page.save()
    return file.getvalue()


def png(drawing: Drawing, dpi: float) -> bytes:
    """Picture whose size in pixels and stated pixels per metre agree exactly."""
    if not 1 <= dpi <= 100_000:
        raise BadParameter("dpi", dpi, "between 1 and 100000")
    # The file holds whole pixels per metre only: draw to that scale.
    per_metre = round(dpi / 0.0254)
    data = cv2.imencode(".png", raster(drawing, per_metre))[1].tobytes()
    body = b"pHYs" + struct.pack(">IIB", per_metre, per_metre, 1)
    chunk = struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))
    after_header = 8 + 25  # signature and IHDR
    return data[:after_header] + chunk + data[after_header:]


FORMATS: dict[str, Callable[[Drawing, float], bytes]] = {
    ".pdf": lambda drawing, _: pdf(drawing),
    ".svg": lambda drawing, _: svg(drawing),
    ".png": png,
}


def _mm(length: float) -> str:
    return f"{1000 * length:.6f}".rstrip("0").rstrip(".")


def _svg_shape(shape: Polygon | Disc) -> str:
    fill = "#000" if shape.black else "#fff"
    if isinstance(shape, Disc):
        x, y = shape.centre
        return f'<circle cx="{_mm(x)}" cy="{_mm(y)}" r="{_mm(shape.radius)}" fill="{fill}"/>'
    corners = " ".join(f"{_mm(x)},{_mm(y)}" for x, y in shape.vertices)
    return f'<polygon points="{corners}" fill="{fill}"/>'


def _svg_text(line: TextLine) -> str:
    size = _mm(line.height / CAPITAL_HEIGHT)
    return (
        f'<text x="{_mm(line.left)}" y="{_mm(line.base)}" font-size="{size}" '
        f'font-family="Helvetica, Arial, sans-serif">{escape(line.text)}</text>'
    )
