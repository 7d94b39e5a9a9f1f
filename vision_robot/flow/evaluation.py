"""Flow against true flow: endpoint error, angular error, outliers."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Bool, Float

__all__ = ["FlowError", "angular_error_deg", "endpoint_error_px", "flow_error", "outliers"]

OUTLIER_PX, OUTLIER_SHARE = 3.0, 0.05
"""KITTI: wrong by more than 3 px and by more than 5 % of the true length."""


@dataclass(frozen=True)
class FlowError:
    """Means over the pixels counted."""

    endpoint_px: float
    """|w − w*|; lower is better."""
    angular_deg: float
    """Between (u, v, 1) and (u*, v*, 1), Barron, Fleet and Beauchemin; lower is better, at most 180."""
    angular_sd_deg: float
    outlier_share: float
    """Share of pixels wrong by more than 3 px and 5 %, from 0 to 1."""
    pixels: int


def flow_error(flow: Array, truth: Array, mask: Bool[Array, "h w"] | None = None) -> FlowError:
    """Errors of a flow (height, width, 2) [px] where the truth is known and `mask` holds."""
    flow, truth = np.asarray(flow, dtype=float), np.asarray(truth, dtype=float)
    if flow.shape != truth.shape or flow.ndim != 3 or flow.shape[2] != 2:
        raise BadParameter(
            "shape of the flow", flow.shape, f"(height, width, 2), as the truth's {truth.shape}"
        )
    counted = np.isfinite(truth).all(axis=-1)
    if mask is not None:
        if np.shape(mask) != counted.shape:
            raise BadParameter("shape of the mask", np.shape(mask), f"{counted.shape}, as the flow's")
        counted &= np.asarray(mask, dtype=bool)
    if not counted.any():
        raise BadParameter("pixels with true flow", 0, "at least one: truth or mask leave none")
    flow, truth = flow[counted], truth[counted]
    if not np.isfinite(flow).all():
        missing = int((~np.isfinite(flow).all(axis=-1)).sum())
        raise BadParameter(
            "flow", f"not a number at {missing} pixels that count", "known there: mask them out"
        )
    angle = angular_error_deg(flow, truth)
    return FlowError(
        endpoint_px=float(endpoint_error_px(flow, truth).mean()),
        angular_deg=float(angle.mean()),
        angular_sd_deg=float(angle.std()),
        outlier_share=float(outliers(flow, truth).mean()),
        pixels=len(flow),
    )


def endpoint_error_px(flow: Float[Array, "*n 2"], truth: Float[Array, "*n 2"]) -> Float[Array, "*n"]:
    """|w − w*| [px]."""
    return np.linalg.norm(flow - truth, axis=-1)


def angular_error_deg(flow: Float[Array, "*n 2"], truth: Float[Array, "*n 2"]) -> Float[Array, "*n"]:
    """Angle between the space-time directions (u, v, 1) and (u*, v*, 1) [degrees].

    By the arc tangent of cross over dot product: the arc cosine loses half its digits where flows are
    nearly right.
    """
    (u, v), (x, y) = np.moveaxis(flow, -1, 0), np.moveaxis(truth, -1, 0)
    cross = np.sqrt((v - y) ** 2 + (x - u) ** 2 + (u * y - v * x) ** 2)
    return np.degrees(np.arctan2(cross, u * x + v * y + 1))


def outliers(flow: Float[Array, "*n 2"], truth: Float[Array, "*n 2"]) -> Bool[Array, "*n"]:
    """KITTI's Fl: wrong by more than 3 px and by more than 5 % of the true length."""
    error = endpoint_error_px(flow, truth)
    return (error > OUTLIER_PX) & (error > OUTLIER_SHARE * np.linalg.norm(truth, axis=-1))
