"""Which direction of a tool's tip a robot's motion leaves unknown, said in words."""

import numpy as np

from vision_robot.errors import TooLittleMotion
from vision_robot.geometry import SE3, rotation_log
from vision_robot.types import Array, Float

__all__ = ["axis_in_words", "check_known", "check_turns", "turning_axis"]

STILL = np.radians(2)
"""Poses turned against each other by less than this do not turn."""

ONE_AXIS = np.radians(2)
"""Turns that leave one axis by less than this are turns about it."""

UNKNOWN = 1e-10
"""Share of the information on the tip that is left once the cameras' places are free."""


def check_turns(base_from_wrist: SE3, *, placed: bool) -> None:
    """Raise TooLittleMotion where the wrist never turns, or about one axis only, before an unknown camera.

    With `placed` cameras each picture sees the tip where it is, and any motion will do.
    """
    if placed:
        return
    axis, spread, across = turning_axis(base_from_wrist)
    if spread < STILL:
        why = "the wrist never turns, so that the tip cannot be told from the camera's place"
        raise TooLittleMotion("the whole tip", why, "turn and tilt the wrist by 20 degrees or more")
    if across < ONE_AXIS:
        named = axis_in_words(axis)
        why = f"the wrist turns about its {named} only and never tilts"
        mend = "tilt the wrist by 15 degrees or more in some poses, or give the camera's place"
        raise TooLittleMotion(f"the tip along the wrist's {named}", why, mend)


def turning_axis(base_from_wrist: SE3) -> tuple[Float[Array, "3"], float, float]:
    """The wrist's own axis about which it turns most, how far [rad], and how far about any other.

    Turns are taken from the middle pose, so that the largest do not hide behind half a turn.
    """
    R = base_from_wrist.rotation
    U, _, Vt = np.linalg.svd(R.mean(axis=0))
    middle = U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt
    turns = rotation_log(middle.T @ R)
    turns = turns - turns.mean(axis=0) if len(turns) > 1 else turns
    _, size, axes = np.linalg.svd(turns, full_matrices=True)
    size = np.pad(size, (0, 3 - len(size))) / np.sqrt(max(len(turns), 1))
    return axes[0], float(size[0]), float(size[1])


def axis_in_words(axis: Float[Array, "3"]) -> str:
    """An axis by its letter where it is one, else by its numbers."""
    largest = int(np.argmax(np.abs(axis)))
    if abs(axis[largest]) > 0.97:
        return f"{'xyz'[largest]} axis"
    pointing = axis * np.sign(axis[largest])
    return f"axis ({', '.join(f'{part:.2f}' for part in pointing)})"


def check_known(information: Float[Array, "3 3"], matrix: Float[Array, "k k"], base_from_wrist: SE3) -> None:
    """Raise TooLittleMotion where the equations themselves leave a direction of the tip free."""
    rest = matrix[3:, 3:]
    reduced = information
    if len(rest):
        scale = 1 / np.sqrt(np.maximum(np.diag(rest), 1e-300))
        inverse = np.linalg.pinv(rest * scale[:, None] * scale, rcond=1e-13)
        border = matrix[:3, 3:] * scale
        reduced = information - border @ inverse @ border.T
    values, vectors = np.linalg.eigh(reduced)
    if values[0] < UNKNOWN * np.trace(information):
        named = axis_in_words(vectors[:, 0])
        axis, spread, _ = turning_axis(base_from_wrist)
        most = f"{np.degrees(spread):.0f} degrees, mostly about the wrist's {axis_in_words(axis)}"
        why = f"the poses turn it by {most}"
        mend = "tilt the wrist in other directions too, or give the camera's place"
        raise TooLittleMotion(f"the tip along the wrist's {named}", why, mend)
