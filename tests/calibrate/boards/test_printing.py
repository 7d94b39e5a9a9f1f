"""Printed targets are to scale: every format is read back and measured."""

import re
import struct
import xml.etree.ElementTree as ET

import cv2
import numpy as np
import pytest
from pypdf import PdfReader

from vision_robot.calibrate.boards import Chessboard, Disc, Drawing
from vision_robot.calibrate.boards.paper import PAGES_MM, on_page
from vision_robot.calibrate.boards.printing import print_drawing
from vision_robot.errors import BadParameter, UnwritableOutput

BOARD = Chessboard(9, 6, 0.025)
POINT_MM = 25.4 / 72
SVG = "{http://www.w3.org/2000/svg}"


def pdf_polygons_mm(path) -> list[np.ndarray]:
    """Vertices of all filled paths, y down from the top of the page [mm]."""
    page = PdfReader(path).pages[0]
    content = page.get_contents()
    assert content is not None
    height = float(page.mediabox.height)
    shapes, current = [], []
    for x, y, operator in re.findall(r"([-\d.]+) ([-\d.]+) ([ml])\b", content.get_data().decode()):
        if operator == "m":
            current = []
            shapes.append(current)
        current.append((float(x) * POINT_MM, (height - float(y)) * POINT_MM))
    return [np.array(shape) for shape in shapes]


def squares_of(shapes: list[np.ndarray]) -> np.ndarray:
    """Left, top, width, height of those that are as large as a square."""
    boxes = [(*s.min(axis=0), *np.ptp(s, axis=0)) for s in shapes]
    return np.array([box for box in boxes if min(box[2:]) > 10])


def check_squares(squares: np.ndarray, left: float, top: float, tolerance: float) -> None:
    """35 black squares of 25 mm on their places."""
    assert len(squares) == 35
    assert squares[:, 2:] == pytest.approx(25, abs=tolerance)
    places = {(c, r) for r in range(7) for c in range(10) if (r + c) % 2 == 0}
    steps = (squares[:, :2] - [left, top]) / 25
    assert np.abs(steps - steps.round()).max() < tolerance / 25
    assert {tuple(map(int, step)) for step in steps.round()} == places


def test_pdf_is_a4_on_its_side_and_to_scale(tmp_path):
    """Page box and squares to a thousandth of a millimetre, ink in the middle."""
    drawing, page = on_page(BOARD.drawing())
    print_drawing(drawing, tmp_path / "board.pdf")
    box = PdfReader(tmp_path / "board.pdf").pages[0].mediabox
    assert page == "a4"
    assert [float(box.width) * POINT_MM, float(box.height) * POINT_MM] == pytest.approx([297, 210], abs=1e-3)
    squares = squares_of(pdf_polygons_mm(tmp_path / "board.pdf"))
    check_squares(squares, 23.5, squares[:, 1].min(), 2e-3)
    assert squares[:, 1].min() > 5


def test_pdf_says_what_it_is_and_has_a_bar_to_measure(tmp_path):
    """The description is text, and the bar's outer ends are 100 mm apart."""
    print_drawing(BOARD.drawing(), tmp_path / "board.pdf")
    text = PdfReader(tmp_path / "board.pdf").pages[0].extract_text()
    assert "chessboard 9x6 inner corners, squares 25 mm" in text
    assert "100 mm" in text
    thin = [s for s in pdf_polygons_mm(tmp_path / "board.pdf") if np.ptp(s, axis=0).min() < 5]
    x = np.concatenate(thin)[:, 0]
    assert np.ptp(x) == pytest.approx(100, abs=2e-3)


def test_svg_is_to_scale(tmp_path):
    """Millimetres as user units, width and height stated in mm."""
    print_drawing(BOARD.drawing(), tmp_path / "board.svg")
    root = ET.parse(tmp_path / "board.svg").getroot()
    assert (root.get("width"), root.get("height"), root.get("viewBox")) == ("300mm", "225mm", "0 0 300 225")
    shapes = [
        np.array([[float(v) for v in point.split(",")] for point in polygon.get("points", "").split()])
        for polygon in root.iter(f"{SVG}polygon")
    ]
    check_squares(squares_of(shapes), 25, 25, 1e-5)
    assert any("squares 25 mm" in (text.text or "") for text in root.iter(f"{SVG}text"))


@pytest.mark.parametrize("dpi", [72, 150])
def test_png_is_to_scale(tmp_path, dpi):
    """The detector finds the corners where the stated resolution puts them, to 0.02 px."""
    print_drawing(BOARD.drawing(), tmp_path / "board.png", dpi=dpi)
    data = (tmp_path / "board.png").read_bytes()
    at = data.index(b"pHYs")
    across, down, unit = struct.unpack(">IIB", data[at + 4 : at + 13])
    assert (across, unit) == (down, 1)
    assert across == pytest.approx(dpi / 0.0254, abs=0.5)
    image = cv2.imread(str(tmp_path / "board.png"), cv2.IMREAD_UNCHANGED)
    assert image is not None
    assert image.shape == (np.ceil(0.225 * across), np.ceil(0.3 * across))
    found = BOARD.detect(image)
    assert found is not None
    expected = (BOARD.points[:, :2] + BOARD.origin_m) * across - 0.5
    assert np.abs(found.pixels - expected).max() < 0.02


def test_discs_are_drawn_in_every_format(tmp_path):
    """Circles have their radius in SVG and PDF."""
    drawing = Drawing(0.1, 0.1, (Disc((0.04, 0.03), 0.01), Disc((0.04, 0.03), 0.005, black=False)))
    for suffix in ("svg", "pdf", "png"):
        print_drawing(drawing, tmp_path / f"disc.{suffix}", dpi=100)
    circle = next(ET.parse(tmp_path / "disc.svg").getroot().iter(f"{SVG}circle"))
    assert (circle.get("cx"), circle.get("cy"), circle.get("r")) == ("40", "30", "10")


def test_same_drawing_same_pdf(tmp_path):
    """No date, no chance: files can be compared."""
    for name in ("a.pdf", "b.pdf"):
        print_drawing(BOARD.drawing(), tmp_path / name)
    assert (tmp_path / "a.pdf").read_bytes() == (tmp_path / "b.pdf").read_bytes()


def test_page_too_small_names_one_that_fits():
    """And unknown pages name the known."""
    drawing = Chessboard(9, 6, 0.035).drawing()
    with pytest.raises(BadParameter, match="at least a3"):
        on_page(drawing, "a4")
    assert on_page(drawing)[1] == "a3"
    with pytest.raises(BadParameter, match="larger than a0"):
        on_page(Chessboard(9, 6, 0.2).drawing())
    with pytest.raises(BadParameter, match="letter"):
        on_page(drawing, "b7")


@pytest.mark.parametrize("page", PAGES_MM)
def test_ink_is_in_the_middle_of_every_page(page):
    """Upright or on its side, whichever way the target lies."""
    for size in ((5, 4), (4, 5)):
        drawing, name = on_page(Chessboard(size[0], size[1], 0.02).drawing(), page)
        left, top, right, bottom = drawing.ink_bounds
        assert name == page
        assert (left, top) == pytest.approx((drawing.width - right, drawing.height - bottom))
        assert (drawing.width > drawing.height) == (size == (5, 4))


@pytest.mark.parametrize("square_m", [0.002, 0.005, 0.03, 0.15])
@pytest.mark.parametrize("size", [(3, 3), (9, 6), (30, 20)])
def test_legend_stays_in_the_margin(size, square_m):
    """Whatever the size, the print below the pattern touches neither the squares nor the page's edge."""
    board = Chessboard(size[0], size[1], square_m)
    drawing = board.drawing()
    below = board.size_m[1] - square_m
    low, high = below + 0.2 * square_m, below + 0.75 * square_m
    squares = (size[0] + 1) * (size[1] + 1)
    for shape in drawing.shapes[(squares + 1) // 2 :]:
        left, top, right, bottom = shape.bounds
        assert low < top < bottom < high
        assert square_m - 1e-9 <= left < right <= board.size_m[0] - square_m + 1e-9
    for line in drawing.texts:
        assert low < line.base - line.height < line.base < high
        assert square_m - 1e-9 <= line.left


def test_bad_files_are_refused(tmp_path):
    """Unknown formats and places that cannot be written leave nothing behind."""
    with pytest.raises(BadParameter, match=r"\.pdf"):
        print_drawing(BOARD.drawing(), tmp_path / "board.doc")
    (tmp_path / "file").write_text("")
    with pytest.raises(UnwritableOutput):
        print_drawing(BOARD.drawing(), tmp_path / "file" / "board.svg")
    assert [p.name for p in tmp_path.iterdir()] == ["file"]
    for dpi in (0, -5, float("nan")):
        with pytest.raises(BadParameter, match="dpi"):
            print_drawing(BOARD.drawing(), tmp_path / "board.png", dpi=dpi)
