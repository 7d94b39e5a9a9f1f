"""The page: what comes from outside stays text, nothing is fetched, the same data give the same bytes."""

import re
from html.parser import HTMLParser

import numpy as np
import pytest

from vision_robot.errors import BadParameter, UnwritableOutput
from vision_robot.report.figure import draw, inline_svg, segments, view_colours
from vision_robot.report.page import (
    Facts,
    Figure,
    Figures,
    Footer,
    Gallery,
    Page,
    Paragraph,
    Picture,
    Remarks,
    Section,
    Table,
    render_page,
    write_page,
)

HOSTILE = '<script>alert("1")</script>&<img src=x onerror=y>"\''
VOID = {"meta", "img", "br", "hr", "link", "input"}


class Reader(HTMLParser):
    """Checks that every tag is closed in turn and gathers what the page holds."""

    def __init__(self, html: str):
        super().__init__(convert_charrefs=True)
        self.open, self.tags, self.attributes, self.text = [], [], [], []
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def drawing(scale: float = 1.0) -> str:
    def paint(canvas):
        axes = canvas.add_subplot()
        axes.plot([0, 0.125, 1], [0, scale, 0.333333])
        segments(axes, np.array([[0.1, 0.2], [0.3, 0.4]]), colour="#123456", width=1)
        axes.set_xlabel("length 0.12345 [mm]")

    return draw(paint, height_in=2)


def page(text: str = "plain") -> Page:
    dot = "data:image/png;base64,iVBORw0KGgo="
    parts = (
        Paragraph(text),
        Remarks((("good", text), ("caution", text))),
        Facts(((text, text, text),)),
        Table(
            (text, "number"), ((text, "1.5"), ("b", "12"), ("c", "−0.25"), ("d", "–")), text, frozenset({1})
        ),
        Figures((Figure(drawing(), text, text), Figure(drawing(), "again", "the same drawing twice"))),
        Gallery((Picture(dot, text, text),)),
    )
    return Page(text, text, (Section(text, parts),), Footer(((text, text),), seed=3, command=text))


def test_a_page_is_well_formed_and_holds_its_parts():
    reader = Reader(render_page(page()))
    assert reader.tags.count("svg") == 2
    assert reader.tags.count("table") == 1
    assert {"h1", "h2", "figcaption", "footer", "dl"} <= set(reader.tags)
    text = " ".join(reader.text)
    assert "Figure 2." in text
    assert "Table 1." in text
    assert "Seed 3." in text


def test_text_from_outside_is_never_markup():
    html = render_page(page(HOSTILE))
    reader = Reader(html)
    assert "script" not in reader.tags
    assert reader.tags.count("img") == 1
    assert not any(name.startswith("on") for name, _ in reader.attributes)
    # It is still there to be read, in text and in the words for those who do not see.
    assert HOSTILE in "".join(reader.text)
    assert ("aria-label", HOSTILE) in reader.attributes
    assert ("alt", HOSTILE) in reader.attributes


def test_a_page_loads_nothing():
    html = render_page(page())
    assert not re.search(r"https?:|//[a-z]|@import|<script|<link|<iframe|<object", html)
    for name, value in Reader(html).attributes:
        if name in ("src", "href", "xlink:href", "data", "srcset", "action"):
            assert value.startswith(("data:", "#"))
        assert "url(" not in (value or "") or re.fullmatch(r"url\(#[\w-]+\)", value)


def test_identifiers_are_unique_and_every_reference_leads_to_one():
    reader = Reader(render_page(page()))
    ids = [value for name, value in reader.attributes if name == "id"]
    assert len(ids) == len(set(ids))
    used = [value[1:] for name, value in reader.attributes if name == "href"]
    used += [value[5:-1] for name, value in reader.attributes if name == "clip-path"]
    used += [value for name, value in reader.attributes if name == "aria-labelledby"]
    assert used
    assert set(used) <= set(ids)


def test_every_drawing_has_words_for_it():
    html = render_page(page())
    assert html.count('role="img" aria-label="') == html.count("<svg ")


def test_the_same_page_is_the_same_bytes():
    assert render_page(page()) == render_page(page())
    assert drawing() == drawing()
    assert drawing(2.0) != drawing()


def test_drawings_are_text_without_date_or_address_and_leave_their_labels_alone():
    svg = inline_svg(drawing(), alt="a", prefix="f1-")
    assert "length 0.12345 [mm]" in svg
    assert "http" not in svg
    assert "date" not in svg.lower()
    assert not re.search(r"\d\.\d{3,}", re.sub(r">[^<]*<", "><", svg))


def test_numbers_are_aligned_on_their_decimal_point():
    table = Table(("a",), (("1.50",), ("12",), ("−0.123",)), "", frozenset({0}))
    cells = [row[0] for row in table.aligned_rows]
    # A figure space is as wide as a digit, a punctuation space as a full stop.
    assert cells == ["1.50\u2007", "12\u2008\u2007\u2007\u2007", "−0.123"]
    whole = Table(("a",), (("1",), ("12",)), "", frozenset({0}))
    assert [row[0] for row in whole.aligned_rows] == ["1", "12"]


def test_a_number_keeps_its_unit_on_its_line():
    html = render_page(page("it is 3.5 ± 0.1 px wide, 40 % of 12 mm"))
    assert "3.5\u00a0±\u00a00.1\u00a0px wide, 40\u00a0% of 12\u00a0mm" in html


def test_a_command_is_given_as_it_was():
    assert "<code>vr calibrate --square 25 mm</code>" in render_page(
        Page("t", "s", (), Footer((), command="vr calibrate --square 25 mm"))
    )


def test_what_cannot_stand_on_a_page_is_refused():
    with pytest.raises(BadParameter, match="picture"):
        Picture("photo.jpg", "", "")
    with pytest.raises(BadParameter, match="cells of a table row is 1: it must be 2"):
        Table(("a", "b"), (("1",),), "")
    with pytest.raises(BadParameter, match="tone"):
        Remarks((("bad", "text"),))


def test_a_page_is_written_whole_or_not_at_all(tmp_path):
    target = tmp_path / "deep" / "page.html"
    write_page(page(), target)
    assert target.read_text(encoding="utf-8") == render_page(page())
    with pytest.raises(UnwritableOutput):
        write_page(page(), tmp_path)


def test_no_view_colour_is_pale():
    for colour in view_colours(40):
        r, g, b = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (r, g, b)]
        luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
        # Web Content Accessibility Guidelines 2.1, 1.4.11: 3:1 for graphics.
        assert 1.05 / (luminance + 0.05) >= 3
