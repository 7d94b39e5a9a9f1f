"""What is asked of a calibration."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from vision_robot.calibrate.warp import HIGHEST_DEGREE
from vision_robot.errors import BadParameter
from vision_robot.geometry.camera import AFFINE_NAMES
from vision_robot.geometry.lens import lens_named
from vision_robot.types import Array, Bool, Float

__all__ = ["Settings"]


@dataclass(frozen=True)
class Settings:
    """Which camera is fitted, and how.

    `fixed` holds intrinsics at a value; `priors` pulls them to (mean, sigma) as one more
    measurement would; `warp` is the degree of the board's smooth departure from its
    drawing, 0 for a board taken as exact; `robust` leaves out corners that noise cannot
    explain.
    """

    model: str = "brown5"
    skew: bool = False
    fixed: Mapping[str, float] = field(default_factory=dict)
    priors: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    warp: int = 0
    robust: bool = True

    def __post_init__(self) -> None:
        names = self.names
        for what, given in (("fixed parameter", self.fixed), ("prior on", self.priors)):
            for name in given:
                if name not in names:
                    raise BadParameter(what, name, f"one of {', '.join(names)}")
        for name, (mean, sigma) in self.priors.items():
            if not (np.isfinite(mean) and np.isfinite(sigma) and sigma > 0):
                raise BadParameter(f"prior on {name}", (mean, sigma), "a finite mean and a positive sigma")
            if name in self.fixed:
                raise BadParameter(f"prior on {name}", (mean, sigma), "left out, since it is fixed")
        for name, value in self.fixed.items():
            if not np.isfinite(value):
                raise BadParameter(f"fixed {name}", value, "finite")
        if self.fixed.get("skew", 0.0) and self.skew:
            raise BadParameter("fixed skew", self.fixed["skew"], "left out where skew is estimated")
        if not (isinstance(self.warp, int) and 0 <= self.warp <= HIGHEST_DEGREE):
            raise BadParameter(
                "degree of the board's warp", self.warp, f"a whole number up to {HIGHEST_DEGREE}"
            )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the camera's parameters."""
        return (*AFFINE_NAMES, *lens_named(self.model).coefficient_names)

    @property
    def free(self) -> Bool[Array, "p"]:
        """Which of the camera's parameters are estimated."""
        held = set(self.fixed) | (set() if self.skew else {"skew"})
        return np.array([name not in held for name in self.names])

    def held(self, parameters: Float[Array, "p"]) -> Float[Array, "p"]:
        """The parameters with the fixed ones at their values."""
        values = np.array(parameters, dtype=float)
        for name, value in self.fixed.items():
            values[self.names.index(name)] = value
        return values
