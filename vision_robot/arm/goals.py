"""Goals as rows of numbers, checked before anything is solved."""

import numpy as np

from vision_robot.errors import BadGoal
from vision_robot.geometry import SE3, SerialChain
from vision_robot.types import Array, Bool, Float

__all__ = ["goal_rows", "poses_of_rows"]

OFF_UNIT = 1e-3
"""Rows of a rotation may be off unit length and right angles by this: rounding in a file, which is mended."""

TOO_FAR = 20
"""A goal this many times the arm's reach away is in other units."""


def goal_rows(base_from_tool: SE3, chain: SerialChain, reach_m: float) -> Float[Array, "goals 12"]:
    """Goal poses as rows of twelve numbers. Raises BadGoal, naming the row, for what can be no goal.

    Rotations off by rounding are replaced by the nearest ones.
    """
    rotation, translation = (
        base_from_tool.rotation.reshape(-1, 3, 3),
        base_from_tool.translation.reshape(-1, 3),
    )
    finite = np.isfinite(rotation).all(axis=(1, 2)) & np.isfinite(translation).all(axis=1)
    _refuse(np.asarray(~finite), "it holds a value that is not finite (NaN or infinity): leave the row out")
    off = np.abs(rotation @ np.swapaxes(rotation, 1, 2) - np.eye(3)).reshape(-1, 9).max(axis=1)
    _refuse(
        off > OFF_UNIT,
        "its rotation matrix is not orthonormal: rows must have length 1 and stand at right angles",
    )
    mirrored = np.asarray(np.linalg.det(rotation) < 0)
    _refuse(mirrored, "its rotation matrix mirrors (determinant -1): exchange or negate an axis")
    origin = chain.base_from_joints(np.zeros(len(chain)))[0].translation
    far = np.linalg.norm(translation - origin, axis=1)
    for row in np.flatnonzero(far > TOO_FAR * reach_m)[:1]:
        raise BadGoal(
            int(row),
            f"it is {far[row]:.4g} m away and the arm reaches {reach_m:.3g} m: positions are in metres; were "
            "millimetres given?",
        )
    needs_mending = off > 1e-12
    if needs_mending.any():
        u, _, vt = np.linalg.svd(rotation[needs_mending])
        rotation = rotation.copy()
        rotation[needs_mending] = u @ vt
    return np.concatenate([rotation, translation[..., None]], axis=2).reshape(-1, 12)


def poses_of_rows(rows: Float[Array, "goals 12"]) -> SE3:
    """The poses of rows of twelve numbers."""
    matrix = rows.reshape(-1, 3, 4)
    return SE3(matrix[..., :3], matrix[..., 3])


def _refuse(bad: Bool[Array, "goals"], why: str) -> None:
    for row in np.flatnonzero(bad)[:1]:
        raise BadGoal(int(row), why)
