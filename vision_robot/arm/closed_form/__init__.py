"""Inverse kinematics in closed form, for the kinds of arm that have one that is known."""

from vision_robot.arm.closed_form.recognise import STRUCTURES, ClosedForm, closed_form_of, structure_of
from vision_robot.arm.closed_form.structure import Structure

__all__ = ["STRUCTURES", "ClosedForm", "Structure", "closed_form_of", "structure_of"]
