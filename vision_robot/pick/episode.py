"""One attempt to pick a thing up and put it down: what was seen, solved, reached, grasped and placed."""

from dataclasses import dataclass, field

import numpy as np

from vision_robot.geometry import SE3
from vision_robot.types import Array, Float

__all__ = ["RUNGS", "Episode", "Look", "Miss", "axis_angle", "miss_of"]

RUNGS = ("seen", "reached", "gripped", "lifted", "placed")
"""The ladder of success; each rung needs the one before."""


@dataclass(frozen=True)
class Miss:
    """Where the tool is against a thing, or a thing against its goal: in the plane of {S}."""

    across_m: float
    """Across the thing's axis, where fingers close."""
    along_m: float
    height_m: float
    yaw_rad: float
    """Of the axes, headless: from -pi/2 to pi/2; NaN for what has no direction."""

    @property
    def position_m(self) -> float:
        """Length of the error in the plane."""
        return float(np.hypot(self.across_m, self.along_m))


@dataclass(frozen=True)
class Look:
    """One look of a closed loop on the way."""

    time_s: float
    error_m: float
    """What was seen: length of the step that it asked for."""
    height_m: float = np.nan
    """Of the tool over the table, as believed."""
    true_m: float = np.nan
    """How far the tool really was off the thing in the plane of {S} when it looked."""
    sigma_m: float = np.nan
    """What all looks up to this one leave unknown of the thing's place, one standard deviation."""


@dataclass(frozen=True)
class Episode:
    """What happened; None where it did not come to that."""

    seed: int
    station_from_object: SE3 = field(compare=False)
    """Where the thing really lay."""
    station_from_place: SE3 = field(compare=False)
    """Where it was to be put."""
    thing: str = ""
    """Name of what was to be picked."""
    closing: Miss | None = None
    """Of the tool against the grasp that was chosen, when the fingers began to close."""
    seen_error_m: float = np.nan
    """Of where the camera said the thing lies."""
    seen_yaw_error_rad: float = np.nan
    reached: bool = False
    gripped: bool = False
    lifted: bool = False
    placed: bool = False
    placing: Miss | None = None
    """Of the thing against its goal, when all is at rest."""
    seconds: float = np.nan
    """Simulated, from the first move to the last."""
    pick_seconds: float = np.nan
    """Simulated, from the first move until it was lifted and held."""
    tries: int = 1
    """How often it was gone for."""
    cleared: int = 0
    """How many things in the way were put aside first."""
    looks: int = 0
    course: tuple[Look, ...] = ()
    """How a closed loop converged."""
    failure: str | None = None
    """Why it ended early, in a sentence."""
    cause: str = ""
    """The same in a word or two, to be counted: one of the causes in `pick.causes`."""

    @property
    def seen(self) -> bool:
        """Whether the tracker said anything."""
        return bool(np.isfinite(self.seen_error_m))

    @property
    def rung(self) -> str:
        """The highest rung reached; empty where nothing was even seen."""
        return next((name for name in reversed(RUNGS) if getattr(self, name)), "")


def axis_angle(rotation: Float[Array, "3 3"], column: int) -> float:
    """Direction in the plane of {S} of a body's axis [rad]."""
    return float(np.arctan2(rotation[1, column], rotation[0, column]))


def miss_of(
    station_from_thing: SE3, position_m: Float[Array, "3"], yaw_rad: float, symmetry_rad: float = np.pi
) -> Miss:
    """How far something at `position_m`, its axis along `yaw_rad`, lies off a thing whose axis is its x.

    Turned by `symmetry_rad` the thing is the same; with 0 it has no direction at all.
    """
    own = axis_angle(station_from_thing.rotation, 0)
    off = position_m - station_from_thing.translation
    c, s = np.cos(own), np.sin(own)
    half = symmetry_rad / 2
    turn = (yaw_rad - own + half) % symmetry_rad - half if symmetry_rad > 0 else np.nan
    return Miss(float(-s * off[0] + c * off[1]), float(c * off[0] + s * off[1]), float(off[2]), float(turn))
