"""Numbers as text, without losing a bit."""

import re
from decimal import Context, Decimal

__all__ = ["is_number", "number_text", "shifted"]

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,4})?", re.ASCII)
_EXACT = Context(prec=60)


def is_number(text: str) -> bool:
    """Whether text is a decimal number; NaN, infinities and Python's 1_000 are not."""
    return len(text) < 1000 and _NUMBER.fullmatch(text) is not None


def number_text(value: float) -> str:
    """Shortest text that reads back as the same float.

    With a point in the mantissa: YAML 1.1 readers take ``1e-05`` for a string.
    """
    text = repr(float(value))
    mantissa, e, exponent = text.partition("e")
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}{e}{exponent}"


def shifted(number: str, by: str) -> str:
    """The decimal number `number` + `by`, exact.

    Pixel conventions differ by 1 or 0.5; in decimals, moving there and back gives the same
    float again, which binary addition does not.
    """
    return str(_EXACT.add(Decimal(number), Decimal(by)))
