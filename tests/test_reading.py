"""Proves that files from anywhere are read within limits, and refused in their reader's words."""

import math
import os

import pytest

from vision_robot.errors import BadTable
from vision_robot.reading import (
    csv_rows,
    json_tree,
    number,
    read_bytes,
    read_text,
    toml_tree,
    xml_root,
)


def refused(call, *arguments) -> str:
    with pytest.raises(BadTable) as caught:
        call(*arguments)
    return str(caught.value)


def test_a_plain_file_is_read_whole(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"\xef\xbb\xbfa\r\nb\rc")
    assert read_bytes(path, BadTable, 9) == path.read_bytes()
    assert read_text(path, BadTable) == "a\nb\nc"


def test_what_is_no_plain_file_of_that_size_is_refused(tmp_path):
    (tmp_path / "large").write_bytes(bytes(2_000_001))
    os.mkfifo(tmp_path / "pipe")
    assert "larger than 2 MB" in refused(read_bytes, tmp_path / "large", BadTable, 2_000_000)
    for path in (tmp_path, tmp_path / "pipe", "/dev/zero"):
        assert "not a plain file" in refused(read_bytes, path, BadTable, 9)
    for path in (tmp_path / "none", tmp_path / ("a" * 300), "a\0b"):
        refused(read_bytes, path, BadTable, 9)


@pytest.mark.parametrize("data", [b"\xff\xfe", b"a\0b", "é".encode("latin-1"), b"\xed\xa0\x80"])
def test_what_is_no_text_is_refused(tmp_path, data):
    (tmp_path / "a").write_bytes(data)
    assert "text" in refused(read_text, tmp_path / "a", BadTable)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1),
        (" -2.5e3 ", -2500),
        (".5", 0.5),
        ("7.", 7),
        ("1e18", 1e18),
        ("1e19", None),
        ("1e999", None),
        ("inf", None),
        ("1_000", None),
        ("0x10", None),
        ("٣", None),
        ("1,5", None),
        ("", None),
        ("9" * 5000, None),
    ],
)
def test_numbers_are_plain_decimals(text, value):
    assert number(text) == value


def test_nan_is_a_number_that_is_none():
    assert math.isnan(number("NaN") or 0)


def test_rows_know_their_lines_and_long_cells_are_refused():
    assert list(csv_rows('a,b\n\n"c\nd",e\n', "x", BadTable)) == [(1, ["a", "b"]), (4, ["c\nd", "e"])]
    assert "line 1: field larger" in refused(lambda: list(csv_rows("a" * 200_000, "x", BadTable)))


def test_trees_are_bounded():
    assert json_tree('{"a": 99999999999999999999}', "x", BadTable) == {"a": 1e20}
    assert "line 2" in refused(json_tree, "{\n]", "x", BadTable)
    assert "nested too deeply" in refused(json_tree, "[" * 100_000, "x", BadTable)
    assert toml_tree("a.b = 1", "x", BadTable) == {"a": {"b": 1}}
    for text in ("a = ", "a = " + "[" * 90_000, "a = " + "9" * 5000, "a." * 40_000 + "a = 1"):
        refused(toml_tree, text, "x", BadTable)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_xml_has_no_entities_of_its_own(encoding):
    bomb = '<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>'.encode(encoding)
    assert "DOCTYPE" in refused(xml_root, bomb, "x", BadTable)
    assert xml_root("<a>&lt;</a>", "x", BadTable).text == "<"


@pytest.mark.parametrize("text", ["<a>" * 2000, '<?xml version="1.0" encoding="none"?><a/>', "<a", ""])
def test_xml_that_is_none_is_refused(text):
    assert "no XML" in refused(xml_root, text.encode(), "x", BadTable)
