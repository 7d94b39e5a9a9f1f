"""Flow of many pixels: Horn and Schunck's equations on a pyramid, the second picture warped each time."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.flow.bonds import bonds
from vision_robot.flow.brightness import exposure_between, noise_sigma
from vision_robot.flow.derivatives import Derivatives, four_point
from vision_robot.flow.equations import FlowEquations
from vision_robot.flow.minimise import Minimum, minimise
from vision_robot.flow.multigrid import Multigrid
from vision_robot.flow.warping import Warp
from vision_robot.types import Array, Float

__all__ = ["FAST", "FlowEstimator", "FlowSettings", "estimate_flow"]

PREFILTER_SIGMA = 0.8
ALPHA_PER_NOISE = 4.0
LEAST_ALPHA = 12.0
COARSEST_SIDE = 24
ON_THE_WAY_PX = 0.05
"""How near to its minimum a flow must be that is only the start of the next."""


@dataclass(frozen=True)
class FlowSettings:
    """How flow is estimated. What is None is chosen from the pictures."""

    alpha: float | None = None
    """Weight of smoothness [grey levels]; None grows with the pictures' noise."""
    break_at: float | None = 0.05
    """Change of flow [px per px] at which it may break; None is Horn and Schunck's smoothness everywhere."""
    robust: float | None = None
    """Grey levels of mismatch beyond which a pixel counts less (Charbonnier); None counts all alike."""
    warps: int = 2
    """Times the second picture is warped back, on each level of the pyramid."""
    median: int = 5
    """Side of the median filter on the flow after each warp; 0 for none."""
    exposure: bool = True
    """Allow for a gain and an offset between the pictures."""
    halvings: int = 0
    """Levels of the pyramid left out at its fine end: 1 estimates on half the pixels per side."""
    tolerance_px: float = 0.01
    """Distance from the minimum of the last energy, rms."""

    def __post_init__(self) -> None:
        for name in ("alpha", "break_at", "robust", "tolerance_px"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value > 0):
                raise BadParameter(name, value, "positive")
        if self.warps < 1:
            raise BadParameter("warps", self.warps, "at least 1")
        if self.median not in (0, 3, 5):
            raise BadParameter("median", self.median, "0, 3 or 5")
        if self.halvings < 0:
            raise BadParameter("halvings", self.halvings, "0 or more")


FAST = FlowSettings(warps=1, halvings=1, tolerance_px=0.05)
"""For video: half the pixels per side, one warp."""


def estimate_flow(first: Array, second: Array, settings: FlowSettings | None = None) -> Minimum:
    """The flow between two grey pictures, for motions of many pixels.

    The distance told is that from the minimum of the last warp's energy, before the median filter.
    """
    return FlowEstimator(settings)(first, second)


class FlowEstimator:
    """Estimates flow for pair after pair of pictures of one size, in the same memory."""

    def __init__(self, settings: FlowSettings | None = None):
        self.settings = settings or FlowSettings()
        self._grids: dict[tuple[int, int], Multigrid] = {}
        self._warps: dict[tuple[int, int], Warp] = {}

    def __call__(self, first: Array, second: Array, *, start: Float[Array, "2 h w"] | None = None) -> Minimum:
        """The flow between two grey pictures; `start` is a guess, such as the flow of the frames before."""
        if np.shape(first) != np.shape(second) or np.ndim(first) != 2:
            allowed = f"two grey pictures of one size, the first being {np.shape(first)}"
            raise BadParameter("shape of the second picture", np.shape(second), allowed)
        alpha = self.settings.alpha
        if alpha is None:
            alpha = float(np.hypot(LEAST_ALPHA, ALPHA_PER_NOISE * noise_sigma(first)))
        levels = list(_pyramid(first, second))
        kept = levels[min(self.settings.halvings, len(levels) - 1) :]
        flow = _resized(start, kept[-1][0].shape) if start is not None else None
        result = None
        for k, (a, b) in reversed(list(enumerate(kept))):
            flow = np.zeros((2, *a.shape), np.float32) if flow is None else _resized(flow, a.shape)
            result = self._level(a, b, flow, alpha, last=k == 0)
            flow = result.flow
        assert result is not None
        return replace(result, flow=_resized(result.flow, np.shape(first)))

    def _level(
        self,
        first: Float[Array, "h w"],
        second: Float[Array, "h w"],
        flow: Float[Array, "2 h w"],
        alpha: float,
        *,
        last: bool,
    ) -> Minimum:
        """Warp and solve, as often as set, on one level of the pyramid."""
        told, result = self.settings, None
        if first.shape not in self._grids:
            self._grids[first.shape], self._warps[first.shape] = Multigrid(first.shape), Warp(first.shape)
        grids = self._grids[first.shape]
        for k in range(told.warps):
            final = last and k == told.warps - 1
            result = minimise(
                self._equations(first, second, flow, alpha),
                start=flow,
                grids=grids,
                tolerance_px=told.tolerance_px if final else ON_THE_WAY_PX,
                most_cycles=30 if final else 1,
            )
            flow = result.flow
            if told.median:
                flow = np.stack([cv2.medianBlur(plane, told.median) for plane in flow])
        assert result is not None
        return replace(result, flow=flow)

    def _equations(
        self, first: Array, second: Array, flow: Float[Array, "2 h w"], alpha: float
    ) -> FlowEquations:
        """Brightness linearised about a flow."""
        told = self.settings
        back, weight = self._warps[first.shape].back(second, flow)
        if told.exposure:
            gain, offset = exposure_between(first, back)
            back = back * np.float32(gain) + np.float32(offset)
        derivatives: Derivatives = four_point(first, back)
        if told.robust is not None:
            weight *= np.reciprocal(cv2.sqrt(1 + np.square(derivatives.t / np.float32(told.robust))))
        bond = None if told.break_at is None else bonds(flow, told.break_at)
        return FlowEquations.around(derivatives, alpha, flow, weight=weight, bond=bond)


def _pyramid(first: Array, second: Array) -> Iterator[tuple[Float[Array, "h w"], Float[Array, "h w"]]]:
    """Both pictures, softened, and at half the size again and again, finest first."""
    pair = tuple(
        cv2.GaussianBlur(np.asarray(p, np.float32), (0, 0), PREFILTER_SIGMA) for p in (first, second)
    )
    yield pair[0], pair[1]
    while min(pair[0].shape) >= 2 * COARSEST_SIDE:
        pair = tuple(cv2.pyrDown(picture) for picture in pair)
        yield pair[0], pair[1]


def _resized(flow: Float[Array, "2 h w"], shape: tuple[int, ...]) -> Float[Array, "2 hh ww"]:
    """The flow on a grid of another size, in that grid's pixels."""
    if flow.shape[1:] == tuple(shape):
        return flow
    size = (shape[1], shape[0])
    scale = (shape[1] / flow.shape[2], shape[0] / flow.shape[1])
    planes = [
        cv2.resize(p, size, interpolation=cv2.INTER_LINEAR) * np.float32(s)
        for p, s in zip(flow, scale, strict=True)
    ]
    return np.stack(planes)
