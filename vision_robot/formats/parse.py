"""YAML and JSON into a `Tree`, built to be safe with files from anywhere.

Both keep numbers as text. YAML is built from parser events into texts, lists and dicts only:
no tag makes an object, depth and count of entries are bounded.
"""

import json
import re
from collections.abc import Iterator

import yaml

from vision_robot.formats.source import CameraSource
from vision_robot.formats.tree import Tree

__all__ = ["parse_json", "parse_yaml"]

MAX_DEPTH = 32
MAX_ENTRIES = 500_000


def parse_json(source: CameraSource) -> Tree:
    """A JSON document; raises BadCameraFile with the line of a fault."""
    try:
        value = json.loads(source.text, parse_float=str, parse_int=str, parse_constant=str)
    except json.JSONDecodeError as error:
        raise source.bad(f"line {error.lineno}: {error.msg}") from error
    except RecursionError as error:
        raise source.bad("it is nested too deeply") from error
    return Tree(source, value)


def parse_yaml(source: CameraSource) -> Tree:
    """The first document of a YAML file; raises BadCameraFile with the line of a fault."""
    loader = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
    # OpenCV's header %YAML:1.0 is no YAML directive; the version changes nothing here.
    text = re.sub(r"\A\s*%YAML[^\n]*", "", source.text)
    # JSON is YAML but for tabs, which it may be indented with.
    text = text.replace("\t", " ") if text.lstrip().startswith("{") else text
    try:
        return Tree(source, _first_document(source, yaml.parse(text, Loader=loader)))
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        raise source.bad(f"{line}{error.problem or error.context}") from error
    except (yaml.YAMLError, ValueError) as error:
        raise source.bad(str(error)) from error


def _first_document(source: CameraSource, events: Iterator[yaml.Event]) -> object:
    """Build the first document from parser events, without recursion.

    Aliases of aliases multiply without end, so that an alias counts as all that it stands for.
    """
    anchors: dict[str, tuple[object, int]] = {}
    open_nodes: list[tuple[list, yaml.CollectionStartEvent, int]] = []
    count = 0
    for event in events:
        count += 1
        if count > MAX_ENTRIES or len(open_nodes) > MAX_DEPTH:
            raise source.bad("it holds more entries, or deeper nested ones, than any camera file")
        before = count
        if isinstance(event, yaml.CollectionStartEvent):
            open_nodes.append(([], event, count))
            continue
        if isinstance(event, yaml.ScalarEvent):
            value, anchor = event.value, event.anchor
        elif isinstance(event, yaml.AliasEvent):
            if event.anchor not in anchors:
                raise source.bad(f"{_line(event)}*{event.anchor} is used before it is defined")
            (value, weight), anchor = anchors[event.anchor], None
            count += weight
        elif isinstance(event, yaml.CollectionEndEvent):
            items, start, before = open_nodes.pop()
            anchor = start.anchor
            value = _mapping(source, items, start) if isinstance(event, yaml.MappingEndEvent) else items
        else:
            continue
        if anchor:
            anchors[anchor] = value, count - before + 1
        if not open_nodes:
            return value
        open_nodes[-1][0].append(value)
    raise source.bad("it is empty")


def _mapping(source: CameraSource, items: list, start: yaml.CollectionStartEvent) -> dict[str, object]:
    keys = items[::2]
    if not all(isinstance(key, str) for key in keys):
        raise source.bad(f"{_line(start)}keys must be words")
    return dict(zip(keys, items[1::2], strict=True))


def _line(event: yaml.Event) -> str:
    return f"line {event.start_mark.line + 1}: " if event.start_mark else ""
