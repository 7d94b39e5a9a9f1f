"""Every figure that a benchmark prints: its unit, which way is better, and what difference matters."""

import math
from dataclasses import dataclass
from typing import Literal

__all__ = ["METRICS", "Metric", "metric_named"]

Better = Literal["higher", "lower"]


@dataclass(frozen=True)
class Metric:
    """What a name means.

    `zone` is the largest difference of no practical consequence, in the metric's unit, used where
    two methods may be called equivalent; `relative_zone` the same as a share of the value, for
    figures without a natural scale.
    """

    name: str
    unit: str
    better: Better
    meaning: str
    zone: float = 0.0
    relative_zone: float = 0.0
    timing: bool = False
    least: float = 0.0
    most: float = math.inf
    """No figure lies outside, so no interval needs to."""

    def zone_at(self, value: float) -> float:
        """Largest difference that matters to nobody where figures are about `value`."""
        return max(self.zone, self.relative_zone * abs(value))


def _share(name: str, meaning: str, zone: float = 0.02, least: float = 0.0) -> Metric:
    return Metric(name, "", "higher", meaning, zone, least=least, most=1.0)


def _error(name: str, unit: str, meaning: str, zone: float) -> Metric:
    return Metric(name, unit, "lower", meaning, zone)


def _time(name: str, unit: str, better: Better, meaning: str) -> Metric:
    return Metric(name, unit, better, meaning, relative_zone=0.10, timing=True)


METRICS = {
    metric.name: metric
    for metric in (
        _error("centroid_error_px", "px", "median distance of matched centroids", 0.1),
        _error("centroid_error_mm", "mm", "the same on the work plane", 0.1),
        _error("yaw_error_deg", "deg", "median angle between matched axes, 0 to 90", 0.5),
        _share("success_auc", "area under the success plot of overlaps (OTB)"),
        _share("precision_auc", "area under the precision plot of 0 to 50 px (OTB)"),
        _share("recall", "share of the truth's rows answered within 20 px"),
        _share("hota", "higher order tracking accuracy"),
        _share("mota", "multiple object tracking accuracy (CLEAR)", least=-math.inf),
        _share("idf1", "identity F1"),
        _share("occlusion_recall", "share of hidden rows still answered"),
        _error("reacquisition_s", "s", "median time until an object that comes out is found", 0.1),
        Metric(
            "streaming_success_auc",
            "",
            "higher",
            "success where an answer counts from when it is there",
            0.02,
            timing=True,
        ),
        _time("latency_p50_ms", "ms", "lower", "median time for a frame"),
        _time("latency_p99_ms", "ms", "lower", "99th percentile of the time for a frame"),
        _time("fps", "1/s", "higher", "frames a second"),
        _time("cpu_ms", "ms", "lower", "processor time for a frame, or a pair of them"),
        _time("cpu_s", "s", "lower", "processor time for the whole video"),
        _time(
            "peak_memory_mb",
            "MB",
            "lower",
            "largest memory held while it worked, beyond what was held before",
        ),
        _time("bandwidth_share", "", "higher", "time to read a frame from memory over the time taken"),
        _error("flow_epe_px", "px", "mean endpoint error", 0.02),
        _error("flow_epe_moving_px", "px", "the same where the true flow is longer than half a pixel", 0.05),
        _error("flow_aae_deg", "deg", "mean angular error (Barron et al.)", 0.2),
        _error("flow_fl", "", "share of pixels off by over 3 px and 5 %", 0.005),
        _error("corner_error_px", "px", "rms per axis of found corners", 0.002),
        _share("boards_found", "share of pictures in which the board was found", 0.01),
        _error("projection_error_px", "px", "rms over the picture to the true camera", 0.01),
        _share("ik_success", "share of reachable targets solved", 0.0005),
        _error("ik_wrong", "", "share of targets told as reached that are not", 0.0005),
        _error(
            "ik_position_error_mm",
            "mm",
            "median distance from the target, whatever the solver says of it",
            0.001,
        ),
        _time("ik_solves_per_s", "1/s", "higher", "targets solved a second on one core"),
        _share("grasp_success", "share of rods lifted and held"),
        _share("place_success", "share of rods put down within tolerance"),
        _error("position_error_mm", "mm", "distance at closing of the gripper", 0.1),
        _error("place_error_mm", "mm", "distance of the thing from its goal, put down", 0.1),
        _error("pick_s", "s", "simulated time from the first move to the last", 0.2),
    )
}


def metric_named(name: str) -> Metric:
    """The metric of that name; a new one without zone, lower is better, for methods that bring their own."""
    return METRICS.get(name, Metric(name, "", "lower", name.replace("_", " "), least=-math.inf))
