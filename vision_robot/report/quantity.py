"""Numbers as people write them: no more digits than are known."""

import math
from collections.abc import Sequence

__all__ = ["compact", "listed", "with_sigma"]


def with_sigma(value: float, sigma: float) -> tuple[str, str]:
    """Value and sigma to two digits of sigma: (1000.7533, 0.4321) -> ("1000.75", "0.43")."""
    if not (math.isfinite(sigma) and sigma > 0):
        return compact(value), "–"
    # Rounding may carry 0.0996 to 0.10: take the digits after it.
    exponent = math.floor(math.log10(float(f"{sigma:.1e}")))
    decimals = min(max(1 - exponent, 0), 12)
    return signed(f"{value:.{decimals}f}"), f"{sigma:.{decimals}f}"


def compact(value: float, digits: int = 3) -> str:
    """A number to so many digits, without an exponent where it can be read."""
    if not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))))
    if not -5 <= exponent <= 6:
        return signed(f"{value:.{digits - 1}e}")
    return signed(f"{value:.{max(digits - 1 - exponent, 0)}f}")


def signed(text: str) -> str:
    """The same with a real minus sign, and none before zero."""
    if text.startswith("-") and not text.strip("-0."):
        return text[1:]
    return text.replace("-", "−")


def listed(names: Sequence[str], most: int = 6) -> str:
    """Names as a sentence lists them: a, b and c; the rest counted when there are too many."""
    if len(names) > most:
        return f"{', '.join(names[: most - 1])} and {len(names) - most + 1} more"
    return (
        " and ".join(", ".join(names).rsplit(", ", 1))
        if not any(", " in n for n in names)
        else "; ".join(names)
    )
