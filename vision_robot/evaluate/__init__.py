"""Metrics as pure functions: each states its formula, its range and its source."""

from vision_robot.evaluate.projection import ProjectionError, projection_difference, projection_error

__all__ = ["ProjectionError", "projection_difference", "projection_error"]
