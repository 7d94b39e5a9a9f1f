"""The linear equations whose solution is the flow, from brightness that does not change along it."""

from dataclasses import dataclass

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.flow.averaging import averaged, binding
from vision_robot.flow.derivatives import Derivatives
from vision_robot.types import Array, Float

__all__ = ["FlowEquations"]


@dataclass(frozen=True)
class FlowEquations:
    """(x u + y v + t) (x, y) + α² (w − w̄) = 0 for every pixel, in float32 (float64 for references).

    They are the minimum of Horn and Schunck's energy, Σ (x u + y v + t)² + α² Σ w·(w − w̄), with the
    brightness derivatives x, y, t.
    """

    x: Float[Array, "h w"]
    y: Float[Array, "h w"]
    t: Float[Array, "h w"]
    alpha: float
    """Weight of smoothness, in grey levels per pixel."""
    bond: Float[Array, "h w"] | None = None
    """How firmly each pixel is bound to its neighbours, 1 where not given (see `averaging`)."""

    def __post_init__(self) -> None:
        if not (np.isfinite(self.alpha) and self.alpha > 0):
            raise BadParameter("alpha", self.alpha, "positive")

    @property
    def shape(self) -> tuple[int, int]:
        """(height, width)."""
        return self.x.shape[0], self.x.shape[1]

    @classmethod
    def around(
        cls,
        derivatives: Derivatives,
        alpha: float,
        flow: Float[Array, "2 h w"],
        *,
        weight: Float[Array, "h w"] | None = None,
        bond: Float[Array, "h w"] | None = None,
    ) -> "FlowEquations":
        """Equations for the whole flow, the second picture having been warped back by `flow`.

        `weight` is how much the brightness of each pixel counts, 1 where not given.
        """
        x, y, t = derivatives
        t = t - x * flow[0] - y * flow[1]
        if weight is not None:
            root = cv2.sqrt(weight)
            x, y, t = x * root, y * root, t * root
        return cls(x, y, t, alpha, bond)

    def residual(self, flow: Float[Array, "2 h w"]) -> Float[Array, "2 h w"]:
        """The left-hand side, negative: zero at the minimiser."""
        miss = self.x * flow[0] + self.y * flow[1] + self.t
        return -(self.alpha**2) * self._bent(flow) - np.stack([self.x * miss, self.y * miss])

    def energy(self, flow: Float[Array, "2 h w"]) -> float:
        """Σ (x u + y v + t)² + α² Σ w·(w − w̄)."""
        miss = self.x * flow[0] + self.y * flow[1] + self.t
        smooth = np.vdot(flow.astype(float), self._bent(flow))
        return float((miss.astype(float) ** 2).sum() + self.alpha**2 * smooth)

    def _bent(self, flow: Float[Array, "2 h w"]) -> Float[Array, "2 h w"]:
        """The smoothness term's derivative, d w − w̄."""
        firm = 1 if self.bond is None else binding(self.bond)
        return firm * flow - averaged(flow, bond=self.bond)
