"""Optical flow by Horn and Schunck's energy, solved to its minimum, and told how near.

`horn_schunck` is the method of 1981 between two pictures, `horn_schunck_sweeps` its usual form that stops
early; `estimate_flow` goes on to motions of many pixels and flow that breaks at the borders of objects.
Flow is (2, height, width), (du, dv) [px] from the first picture to the second; evaluation and files have it
last.
"""

from vision_robot.flow.consistency import occluded, there_and_back
from vision_robot.flow.derivatives import Derivatives, cube, four_point, prefiltered
from vision_robot.flow.equations import FlowEquations
from vision_robot.flow.estimate import FAST, FlowEstimator, FlowSettings, estimate_flow
from vision_robot.flow.evaluation import FlowError, flow_error
from vision_robot.flow.horn_schunck import horn_schunck, horn_schunck_sweeps
from vision_robot.flow.minimise import Minimum, minimise
from vision_robot.flow.multigrid import Multigrid
from vision_robot.flow.sequence import FlowSequence

__all__ = [
    "FAST",
    "Derivatives",
    "FlowEquations",
    "FlowError",
    "FlowEstimator",
    "FlowSequence",
    "FlowSettings",
    "Minimum",
    "Multigrid",
    "cube",
    "estimate_flow",
    "flow_error",
    "four_point",
    "horn_schunck",
    "horn_schunck_sweeps",
    "minimise",
    "occluded",
    "prefiltered",
    "there_and_back",
]
