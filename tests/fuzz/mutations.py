"""Ways in which a file goes wrong: by accident on its way, by a careless writer, by an attacker."""

import json
import re
from collections.abc import Callable
from random import Random
from typing import Any

__all__ = ["mutated"]

NUMBERS = (
    "nan", "NaN", ".nan", "inf", "-inf", "Infinity", ".Inf", "-0", "0", "-1", "1e308", "-1e308", "1e999",
    "1e-320", "0.5", "2147483648", "4294967296", "9223372036854775808", "9" * 400, "9" * 5000, "1_000",
    "0x10", "1,5", "٣", "1e", "--1", "100000", "100001", "1000000000000",
)  # fmt: skip
WORDS = (
    "", " ", "null", "true", "[]", "{}", '""', "[[[[[1]]]]]", "none", "../../../outside", "/etc/passwd",
    "\x1b[2J", "{0.__class__}", "%s%n", "${HOME}", "$(touch pwned)", "`touch pwned`", "<script>", "é", "😀",
    "__import__('os').system('touch pwned')", "!!python/object/apply:os.system ['touch pwned']", "\u202e",
    "a" * 70000,
)  # fmt: skip
VALUES: tuple[Any, ...] = (
    None, True, False, 0, -1, 1.5, 1e308, -1e308, float("nan"), float("inf"), 10**12, 10**30, "", "word",
    "../up", [], {}, [[]], [None], ["x"], {"": 0}, [1, 2], [1e308] * 3, [[1] * 4] * 4,
)  # fmt: skip
BRACKETS = ("[", "{", "(", "<a>", '{"a":', "- ", "[[", '"', "'", "\\", "<!--", "&a [*a")
SIGNS = (",", ";", "\t", "#", "\r", "\n\n", '"', "&", "*", "|", ":")

NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
WORD = re.compile(r"[A-Za-z_]\w*")


def mutated(data: bytes, rng: Random, others: list[bytes]) -> bytes:
    """`data` with one to four things wrong; `others` are files of the same kind to be mixed with."""
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 4))):
        data = _once(data, rng, others)
    return data


def _once(data: bytes, rng: Random, others: list[bytes]) -> bytes:
    text = _text(data)
    if text is None or rng.random() < 0.1:
        return _bytes_wrong(data, rng, others)
    tree = _tree(text)
    if tree is not None and rng.random() < 0.5:
        return json.dumps(_tree_wrong(tree, rng)).encode(errors="surrogatepass")
    if rng.random() < 0.1:
        return _encoding_wrong(text, rng)
    return _text_wrong(text, rng).encode(errors="surrogatepass")


def _text(data: bytes) -> str | None:
    try:
        text = data.decode()
    except UnicodeDecodeError:
        return None
    return None if "\0" in text else text


def _tree(text: str) -> Any:
    if text[:1] not in ("{", "[") or len(text) > 200_000:
        return None
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def _bytes_wrong(data: bytes, rng: Random, others: list[bytes]) -> bytes:
    if not data:
        return rng.randbytes(rng.randrange(1, 64))
    # Headers are where sizes stand: half of all faults hit the first bytes.
    at = rng.randrange(min(len(data), 96)) if rng.random() < 0.5 else rng.randrange(len(data))
    length = min(rng.choice((1, 2, 4, 8, 64, 1000)), len(data) - at)
    before, here, after = data[:at], data[at : at + length], data[at + length :]
    other = rng.choice(others or [data])
    ways: tuple[Callable[[], bytes], ...] = (
        lambda: before,
        lambda: before + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :],
        lambda: before + after,
        lambda: before + here * rng.choice((2, 3, 50)) + after,
        lambda: before + rng.randbytes(length) + after,
        lambda: before + rng.choice((b"\0", b"\xff", b"\x7f", b"\x80")) * length + after,
        lambda: _size_wrong(data, at, rng),
        lambda: before + other[rng.randrange(len(other) + 1) :],
    )
    return rng.choice(ways)()


def _size_wrong(data: bytes, at: int, rng: Random) -> bytes:
    """A whole number written over, such as a length or a count."""
    size = rng.choice((2, 4, 8))
    most = 2 ** (8 * size)
    value = rng.choice((0, 1, most - 1, most // 2, most // 2 - 1, 65537 % most))
    return data[:at] + value.to_bytes(size, rng.choice(("little", "big"))) + data[at + size :]


def _text_wrong(text: str, rng: Random) -> str:
    lines = text.split("\n")
    i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    at = rng.randrange(len(text) + 1)
    ways: tuple[Callable[[], str], ...] = (
        *[lambda: _replaced(text, NUMBER, rng.choice(NUMBERS), rng)] * 3,
        lambda: _replaced(text, NUMBER, rng.choice(WORDS), rng),
        lambda: _replaced(text, WORD, rng.choice((*WORDS, *NUMBERS)), rng),
        lambda: "\n".join(lines[:i] + lines[i + 1 :]),
        lambda: "\n".join(lines[:i] + [lines[i]] * rng.choice((2, 3, 400)) + lines[i + 1 :]),
        lambda: "\n".join([*lines[:i], lines[j], *lines[i + 1 :]]),
        lambda: text[:at] + rng.choice(BRACKETS) * rng.choice((1, 2, 60, 3000, 100_000)) + text[at:],
        lambda: text[:at] + rng.choice((*WORDS, *SIGNS)) + text[at:],
    )
    return rng.choice(ways)()


def _replaced(text: str, pattern: re.Pattern[str], by: str, rng: Random) -> str:
    found = list(pattern.finditer(text[:300_000]))
    if not found:
        return text + by
    one = rng.choice(found)
    return text[: one.start()] + by + text[one.end() :]


def _encoding_wrong(text: str, rng: Random) -> bytes:
    way = rng.choice(("utf-16", "utf-16-le", "utf-8-sig", "latin-1", "crlf", "cr", "utf-7"))
    if way in ("crlf", "cr"):
        return text.replace("\n", "\r\n" if way == "crlf" else "\r").encode(errors="surrogatepass")
    return text.encode(way, errors="ignore")


def _tree_wrong(tree: Any, rng: Random) -> Any:
    """The tree with one of its places replaced, emptied or doubled."""
    places = list(_places(tree))
    if not places:
        return rng.choice(VALUES)
    holder, key = rng.choice(places)
    way = rng.randrange(4)
    if way == 0:
        del holder[key]
    elif way == 1 and isinstance(holder, list):
        holder.insert(key, rng.choice(VALUES))
    elif way == 2:
        other, name = rng.choice(places)
        if name in other if isinstance(other, dict) else name < len(other):
            holder[key] = json.loads(json.dumps(other[name]))
    else:
        holder[key] = rng.choice(VALUES)
    return tree


def _places(tree: Any, depth: int = 0) -> Any:
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield tree, key
        if depth < 12:
            yield from _places(value, depth + 1)
