"""Joints of the project's own arm for a tool that points straight down, in closed form."""

import numpy as np

UPPER, FORE, TOOL_AT_ZERO = 0.30, 0.25, 0.05


def tool_down(x: float, y: float, z: float, yaw: float) -> np.ndarray:
    """Joints that bring the tool to (x, y, z) in {B}, closing along `yaw` [m, rad]."""
    cosine = (x * x + y * y - UPPER**2 - FORE**2) / (2 * UPPER * FORE)
    elbow = np.arccos(cosine)
    shoulder = np.arctan2(y, x) - np.arctan2(FORE * np.sin(elbow), UPPER + FORE * np.cos(elbow))
    roll = (shoulder + elbow - yaw + np.pi) % (2 * np.pi) - np.pi
    return np.array([z - TOOL_AT_ZERO, shoulder, elbow, 0.0, roll])
