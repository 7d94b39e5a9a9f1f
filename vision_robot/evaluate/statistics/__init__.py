"""What figures measured on a few seeds allow to say, and what they do not."""

from vision_robot.evaluate.statistics.breakdown import Breakdown, breakdown_point
from vision_robot.evaluate.statistics.interval import Interval, clustered_interval, wilson_interval
from vision_robot.evaluate.statistics.paired import PairedTest, compare_pairs, holm
from vision_robot.evaluate.statistics.power import detectable, seeds_needed
from vision_robot.evaluate.statistics.ranking import Ranking, rank_methods

__all__ = [
    "Breakdown",
    "Interval",
    "PairedTest",
    "Ranking",
    "breakdown_point",
    "clustered_interval",
    "compare_pairs",
    "detectable",
    "holm",
    "rank_methods",
    "seeds_needed",
    "wilson_interval",
]
