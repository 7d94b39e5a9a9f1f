"""What a value in a recipe may be, how it is drawn by chance and how it goes between two others."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vision_robot.reading import LARGEST_NUMBER
from vision_robot_synth.recipe.colours import COLOURS, colour_named

__all__ = ["Choice", "Colour", "Flag", "Kind", "Number", "Numbers", "Text", "Whole"]


class Kind(ABC):
    """One kind of value."""

    @property
    @abstractmethod
    def allowed(self) -> str:
        """What is allowed, to follow "must be"."""

    @abstractmethod
    def checked(self, value: Any) -> Any:
        """The value in its own type; None where it is not allowed."""

    def drawn(self, value: Any, rng: np.random.Generator) -> Any:  # noqa: ARG002 - most have no ranges
        """One value where a range is given."""
        return value

    def between(self, low: Any, high: Any, share: float) -> Any:
        """The value at `share` of the way from one to the other; the nearer one where there is no way."""
        return low if share < 0.5 else high


@dataclass(frozen=True)
class Number(Kind):
    """A number, or a pair [least, most] from which one is drawn evenly."""

    least: float = -math.inf
    most: float = math.inf
    ranged: bool = True

    @property
    def allowed(self) -> str:
        """Such as: a number from 0 to 1, or a pair [least, most] to draw from."""
        bounds = {
            (False, False): "a number",
            (True, False): f"a number from {self.least:g} on",
            (False, True): f"a number up to {self.most:g}",
            (True, True): f"a number from {self.least:g} to {self.most:g}",
        }[math.isfinite(self.least), math.isfinite(self.most)]
        return bounds + (", or a pair [least, most] to draw from" if self.ranged else "")

    def checked(self, value: Any) -> Any:
        """A float or a pair of them."""
        if self.ranged and isinstance(value, list | tuple) and len(value) == 2:
            low, high = (self._number(one) for one in value)
            return None if low is None or high is None or low > high else (low, high)
        return self._number(value)

    def _number(self, value: Any) -> float | None:
        good = isinstance(value, int | float) and not isinstance(value, bool)
        inside = good and self.least <= value <= self.most and abs(value) <= LARGEST_NUMBER
        return float(value) if inside else None

    def drawn(self, value: Any, rng: np.random.Generator) -> Any:
        """Evenly from the pair."""
        if not isinstance(value, tuple):
            return value
        return value[0] + rng.random() * (value[1] - value[0])

    def between(self, low: Any, high: Any, share: float) -> Any:
        """Linearly, the ends of pairs each for itself."""
        if isinstance(low, tuple) or isinstance(high, tuple):
            low, high = (one if isinstance(one, tuple) else (one, one) for one in (low, high))
            return tuple(a + share * (b - a) for a, b in zip(low, high, strict=True))
        return low + share * (high - low)


@dataclass(frozen=True)
class Whole(Number):
    """A whole number, or a pair of them from which one is drawn."""

    @property
    def allowed(self) -> str:
        """As for numbers."""
        return super().allowed.replace("a number", "a whole number")

    def _number(self, value: Any) -> float | None:
        number = super()._number(value)
        return number if number is not None and number == int(number) else None

    def checked(self, value: Any) -> Any:
        """An int or a pair of them."""
        found = super().checked(value)
        if found is None:
            return None
        return tuple(map(int, found)) if isinstance(found, tuple) else int(found)

    def drawn(self, value: Any, rng: np.random.Generator) -> Any:
        """Evenly, both ends included."""
        return int(rng.integers(value[0], value[1] + 1)) if isinstance(value, tuple) else value

    def between(self, low: Any, high: Any, share: float) -> Any:
        """Rounded."""
        found = super().between(low, high, share)
        return tuple(map(round, found)) if isinstance(found, tuple) else round(found)


@dataclass(frozen=True)
class Numbers(Kind):
    """So many numbers in a list."""

    count: tuple[int, ...]
    least: float = -math.inf
    whole: bool = False
    most: float = math.inf

    @property
    def allowed(self) -> str:
        """Such as: a list of 2 whole numbers from 16 on."""
        counts = " or ".join(map(str, self.count))
        bound = f" from {self.least:g} on" if math.isfinite(self.least) else ""
        bound = f" from {self.least:g} to {self.most:g}" if math.isfinite(self.most) else bound
        return f"a list of {counts} {'whole ' if self.whole else ''}numbers{bound}"

    def checked(self, value: Any) -> Any:
        """A tuple."""
        if not isinstance(value, Sequence) or isinstance(value, str) or len(value) not in self.count:
            return None
        one = (Whole if self.whole else Number)(self.least, self.most, ranged=False)
        found = tuple(one.checked(number) for number in value)
        return None if None in found else found

    def between(self, low: Any, high: Any, share: float) -> Any:
        """Linearly, each for itself."""
        found = tuple(a + share * (b - a) for a, b in zip(low, high, strict=True))
        return tuple(map(round, found)) if self.whole else found


@dataclass(frozen=True)
class Colour(Kind):
    """A colour by name, as "#rrggbb", or [red, green, blue] from 0 to 1; a list of them is drawn from."""

    optional: bool = False

    @property
    def allowed(self) -> str:
        """The names."""
        none = ', or "none"' if self.optional else ""
        return f"{', '.join(COLOURS)}, #rrggbb, [red, green, blue] of 0 to 1, or a list of colours{none}"

    def checked(self, value: Any) -> Any:
        """A tuple of colours, each three numbers; an empty one for none."""
        if self.optional and value in ("none", ()):
            return ()
        one = colour_named(value)
        if one is not None:
            return (one,)
        many = [colour_named(item) for item in value] if isinstance(value, list | tuple) else []
        return tuple(many) if many and None not in many else None

    def between(self, low: Any, high: Any, share: float) -> Any:
        """Each colour of the first towards the first of the other, linearly in red, green and blue."""
        return tuple(
            tuple(a + share * (b - a) for a, b in zip(one, high[i % len(high)], strict=True))
            for i, one in enumerate(low)
        )


@dataclass(frozen=True)
class Choice(Kind):
    """One of some words."""

    words: tuple[str, ...]

    @property
    def allowed(self) -> str:
        """The words."""
        return f"one of {', '.join(self.words)}"

    def checked(self, value: Any) -> Any:
        """The word."""
        return value if value in self.words else None


@dataclass(frozen=True)
class Flag(Kind):
    """True or false."""

    @property
    def allowed(self) -> str:
        """Both."""
        return "true or false"

    def checked(self, value: Any) -> Any:
        """A bool."""
        return value if isinstance(value, bool) else None


@dataclass(frozen=True)
class Text(Kind):
    """Words in quotes."""

    @property
    def allowed(self) -> str:
        """Any."""
        return "words in quotes"

    def checked(self, value: Any) -> Any:
        """A str."""
        return value if isinstance(value, str) else None
