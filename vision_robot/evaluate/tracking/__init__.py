"""How well tracks follow the truth: every metric a pure function of two tables of tracks."""

from vision_robot.evaluate.tracking.clear import ClearScores, clear_scores
from vision_robot.evaluate.tracking.encounters import Encounters, encounters
from vision_robot.evaluate.tracking.hota import HotaScores, hota_scores
from vision_robot.evaluate.tracking.identity import IdentityScores, identity_scores
from vision_robot.evaluate.tracking.localisation import LocalisationScores, localisation_scores
from vision_robot.evaluate.tracking.occlusion import OcclusionScores, occlusion_scores
from vision_robot.evaluate.tracking.overlap import box_overlap, closeness
from vision_robot.evaluate.tracking.single_object import SingleObjectScores, single_object_scores

__all__ = [
    "ClearScores",
    "Encounters",
    "HotaScores",
    "IdentityScores",
    "LocalisationScores",
    "OcclusionScores",
    "SingleObjectScores",
    "box_overlap",
    "clear_scores",
    "closeness",
    "encounters",
    "hota_scores",
    "identity_scores",
    "localisation_scores",
    "occlusion_scores",
    "single_object_scores",
]
