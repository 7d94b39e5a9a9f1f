"""How large a model an MJCF file asks for, told before MuJoCo makes it.

A few bytes can ask for thousands of millions of bodies, pixels or numbers, which MuJoCo sets out to make.
"""

import math
from pathlib import Path
from xml.etree.ElementTree import Element

from vision_robot.errors import BadArm
from vision_robot.reading import LARGEST_TREE, read_bytes, xml_root

__all__ = ["refuse_oversized"]

MOST_COPIES = 5_000
"""MuJoCo takes seconds for 10 000 bodies, and a hundred times as long for ten times as many."""
COUNTS = {
    "replicate": (("count",), MOST_COPIES),
    "composite": (("count",), MOST_COPIES),
    "flexcomp": (("count",), MOST_COPIES),
    "hfield": (("nrow", "ncol"), 100_000_000),
    "texture": (("width", "height"), 100_000_000),
}
"""Element -> the attributes whose product says how many things it stands for, and the most allowed."""

MOST_NUMBERS = 10_000
"""Each number of <size> but those that only reserve memory, which MuJoCo refuses itself."""
RESERVING = ("memory", "njmax", "nconmax", "nstack")
MOST_FILES = 100


def refuse_oversized(path: Path) -> None:
    """Raise BadArm for an MJCF file that, with what it includes, asks for more than any arm has."""
    waiting, seen = [path], set()
    while waiting:
        file = waiting.pop()
        if file in seen:
            continue  # MuJoCo itself refuses it
        seen.add(file)
        if len(seen) > MOST_FILES:
            raise BadArm(path, f"it includes more than {MOST_FILES} files")
        root = xml_root(read_bytes(file, BadArm, LARGEST_TREE), file, BadArm)
        _check(path, root)
        named = [name for one in root.iter("include") if (name := one.get("file"))]
        places = {folder / name for name in named for folder in (path.parent, file.parent)}
        waiting += [place for place in places if place.exists()]  # what is missing MuJoCo names itself


def _check(path: Path, root: Element) -> None:
    waiting = [(root, 1.0)]
    while waiting:
        element, times = waiting.pop()
        count, most = _count(element)
        if times * count > most:
            asked = f"its <{element.tag}> asks for {times * count:.3g} things"
            raise BadArm(path, f"{asked}; at most {most} are made")
        waiting += [(child, times * count if element.tag == "replicate" else times) for child in element]


def _count(element: Element) -> tuple[float, int]:
    if element.tag == "size":
        numbers = (_product(value) for name, value in element.items() if name not in RESERVING)
        return max(numbers, default=1.0), MOST_NUMBERS
    names, most = COUNTS.get(element.tag, ((), MOST_COPIES))
    return math.prod(_product(element.get(name, "1")) for name in names), most


def _product(text: str) -> float:
    """Of the numbers in an attribute; what is no number MuJoCo refuses by itself."""
    try:
        return math.prod(abs(float(word)) for word in text.split())
    except ValueError:
        return 1.0
