"""All figures of a tracker on one video, by the names that `vr benchmark` prints."""

import numpy as np

from vision_robot.evaluate.tracking.clear import clear_scores
from vision_robot.evaluate.tracking.encounters import encounters
from vision_robot.evaluate.tracking.hota import hota_scores
from vision_robot.evaluate.tracking.identity import identity_scores
from vision_robot.evaluate.tracking.localisation import localisation_scores, matches
from vision_robot.evaluate.tracking.occlusion import occlusion_scores
from vision_robot.evaluate.tracking.single_object import single_object_scores
from vision_robot.tracks import Tracks

__all__ = ["tracking_figures"]

HIDDEN = 0.999
"""Hidden more than this, an object is in nobody's picture."""

STAND_IN = {
    "centroid_px": ("centre_u_px", "centre_v_px"),
    "box_px": ("amodal_left_px", "amodal_top_px", "amodal_width_px", "amodal_height_px"),
}
"""Further columns of a truth that tell where an object would be seen if nothing stood before it."""


def tracking_figures(truth: Tracks, answer: Tracks, *, gate_px: float = 20.0) -> dict[str, float]:
    """Figures by metric name; NaN where the truth does not tell, such as millimetres without a plane.

    Success and precision are means over the truth's objects. What cannot be seen (`occluded` over 0.999)
    need not be found and is not wrong when a tracker knows where it is: only the scores of occlusion ask.
    """
    truth = _placed(truth)
    occluded = truth.extra.get("occluded", np.zeros(len(truth)))
    hidden = np.nan_to_num(occluded, nan=1.0) > HIDDEN
    whole = encounters(truth, answer)
    here, there = matches(whole, gate_px)
    guessed = np.zeros(len(answer), dtype=bool)
    guessed[there[hidden[here]]] = True
    seen = encounters(truth.rows(np.flatnonzero(~hidden)), answer.rows(np.flatnonzero(~guessed)))

    places, hota = localisation_scores(seen, gate_px=gate_px), hota_scores(seen)
    each = [single_object_scores(seen, int(one)) for one in seen.truth.ids]
    figures = {
        "centroid_error_px": places.centroid_error_px,
        "centroid_error_mm": 1e3 * places.centroid_error_m,
        "yaw_error_deg": float(np.degrees(places.yaw_error_rad)),
        "success_auc": _mean([one.success_auc for one in each]),
        "precision_auc": _mean([one.precision_auc for one in each]),
        "recall": places.recall,
        "hota": hota.hota,
        "mota": clear_scores(seen).mota,
        "idf1": identity_scores(seen).idf1,
    }
    if "occluded" in truth.extra:
        hiding = occlusion_scores(whole, gate_px=gate_px)
        figures |= {"occlusion_recall": hiding.recall, "reacquisition_s": hiding.reacquisition_s}
    return figures


def _placed(truth: Tracks) -> Tracks:
    """The rows whose place is known, from the stand-ins where the object itself is not seen."""
    columns = {name: getattr(truth, name) for name in truth.__dataclass_fields__}
    for name, others in STAND_IN.items():
        if all(other in truth.extra for other in others):
            hidden = np.stack([truth.extra[other] for other in others], axis=1)
            columns[name] = np.where(np.isfinite(columns[name]), columns[name], hidden)
    filled = Tracks(**columns)
    places = np.column_stack([filled.centroid_px, filled.box_px])
    return filled.rows(np.flatnonzero(np.isfinite(places).all(axis=1)))


def _mean(values: list[float]) -> float:
    return float(np.mean(values)) if values else np.nan
