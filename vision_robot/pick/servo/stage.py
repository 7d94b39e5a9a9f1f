"""What a law of servoing can do and see: the same for physics and for a simulation without."""

from dataclasses import dataclass
from typing import Protocol

from vision_robot.geometry import WorkPlane
from vision_robot.pick.sighting import Sighting
from vision_robot.types import Array, Float

__all__ = ["Glimpse", "Stage"]


@dataclass(frozen=True)
class Glimpse:
    """The label on the hand in one picture, beside where the joints of that moment say it is."""

    time_s: float
    pixel: Float[Array, "2"]
    label_in_station: Float[Array, "3"]
    sigma_px: float
    """Standard deviation of `pixel` per axis."""


class Stage(Protocol):
    """A hand that moves over the table, and a camera that looks at its label."""

    @property
    def plane(self) -> WorkPlane:
        """The camera as it is believed to stand."""
        ...

    @property
    def time_s(self) -> float:
        """Now."""
        ...

    @property
    def period_s(self) -> float:
        """From one picture to the next."""
        ...

    @property
    def latency_s(self) -> float:
        """From a picture's moment to what was seen in it."""
        ...

    def go(self, place: Sighting, height_m: float) -> None:
        """Bring the label over `place`, the tool beside it `height_m` high, and stand still there.

        By the joints: where the camera sees it is another matter.
        """
        ...

    def step(self, place: Sighting, height_m: float) -> None:
        """Send the label towards there for one period."""
        ...

    def wait(self, seconds: float) -> None:
        """Stand still."""
        ...

    def look(self) -> Glimpse:
        """A picture of this moment; raises NothingSeen where the label is hidden in part or not seen."""
        ...

    def note(self, error_m: float, sigma_m: float = ...) -> None:
        """Keep an error for the record of how the loop converged."""
        ...
