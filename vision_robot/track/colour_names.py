"""Colours by name, as regions of hue, saturation and value."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Bool

__all__ = ["COLOURS", "NamedColour", "colour_named"]


@dataclass(frozen=True)
class NamedColour:
    """Hue from `first` to `last` [degrees, red at 0, through 360]; least and most saturation and value."""

    first: float = 0.0
    last: float = 360.0
    saturation: tuple[float, float] = (0.4, 1.0)
    value: tuple[float, float] = (0.2, 1.0)

    @property
    def has_hue(self) -> bool:
        """Whether it is more than a shade of grey."""
        return self.last - self.first < 360

    def holds(self, colours: Array) -> Bool[Array, "..."]:
        """Which blue-green-red colours (last axis, 0 to 255) have this name."""
        bgr = np.asarray(colours, dtype=np.float32) / 255
        value, least = bgr.max(axis=-1), bgr.min(axis=-1)
        spread = value - least
        blue, green, red = bgr[..., 0], bgr[..., 1], bgr[..., 2]
        with np.errstate(invalid="ignore", divide="ignore"):
            hue = np.where(
                value == red,
                ((green - blue) / spread) % 6,
                np.where(value == green, (blue - red) / spread + 2, (red - green) / spread + 4),
            )
            saturation = np.where(value > 0, spread / value, 0)
        hue = np.where(spread > 0, 60 * hue, self.first)
        right_hue = ((hue - self.first) % 360 <= self.last - self.first) if self.has_hue else True
        return (
            right_hue
            & (saturation >= self.saturation[0])
            & (saturation <= self.saturation[1])
            & (value >= self.value[0])
            & (value <= self.value[1])
        )


COLOURS: dict[str, NamedColour] = {
    "red": NamedColour(340, 375),
    "orange": NamedColour(15, 40, value=(0.45, 1)),
    "yellow": NamedColour(40, 70, value=(0.35, 1)),
    "green": NamedColour(70, 165, saturation=(0.3, 1), value=(0.15, 1)),
    "cyan": NamedColour(165, 200),
    "blue": NamedColour(200, 260, value=(0.15, 1)),
    "purple": NamedColour(260, 300, saturation=(0.25, 1)),
    "pink": NamedColour(300, 340, saturation=(0.25, 1), value=(0.4, 1)),
    "brown": NamedColour(10, 45, saturation=(0.3, 1), value=(0.15, 0.5)),
    "white": NamedColour(saturation=(0, 0.15), value=(0.8, 1)),
    "grey": NamedColour(saturation=(0, 0.15), value=(0.3, 0.7)),
    "black": NamedColour(saturation=(0, 1), value=(0, 0.18)),
}
"""Hues overlap a little where people disagree."""

ALIASES = {"gray": "grey", "violet": "purple", "magenta": "pink", "turquoise": "cyan"}


def colour_named(name: str) -> NamedColour:
    """The colour of that name; raises BadParameter listing those there are."""
    word = name.strip().lower()
    word = ALIASES.get(word, word)
    if word not in COLOURS:
        raise BadParameter("colour", name, f"one of {', '.join(COLOURS)}; or pick a point instead")
    return COLOURS[word]
