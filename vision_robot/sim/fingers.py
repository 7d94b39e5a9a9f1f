"""The fingers of a gripper as its model has them: how far they open, how thick they are and how long."""

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["Fingers", "fingers_of"]

MjModel: TypeAlias = Any
MjData: TypeAlias = Any

CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)

PADS_M = 0.02
"""How far along the fingers from the tool what is nearest to the other finger counts as a pad."""


@dataclass(frozen=True)
class Fingers:
    """Two fingers along the tool's z that close along its x."""

    gap_m: float
    """Between the pads, as the model stands."""
    thickness_m: float
    """From a pad's face to the outside of its finger."""
    breadth_m: float
    """Along the tool's y."""
    tip_m: float
    """How far the tips reach past the tool."""
    closing: Float[Array, "2"]
    """Direction in which they close, in the tool's x and y; (1, 0) as it should be."""


def fingers_of(model: MjModel, data: MjData, prefix: str, joint_ids: list[int]) -> Fingers | None:
    """The fingers of the arm whose names begin with `prefix` and whose own joints are `joint_ids`.

    Fingers are the bodies beyond the tool's that move by other joints; boxes around their shapes stand for
    them. None where there are none.
    """
    geoms = _finger_geoms(model, prefix, joint_ids)
    if not len(geoms):
        return None
    site = data.site(prefix + "tool")
    R = site.xmat.reshape(3, 3)
    turned = data.geom_xmat[geoms].reshape(-1, 3, 3)
    middle, half = model.geom_aabb[geoms, None, :3], model.geom_aabb[geoms, None, 3:]
    corners = (middle + half * CORNERS) @ np.swapaxes(turned, 1, 2) + data.geom_xpos[geoms, None]
    in_tool = (corners - site.xpos) @ R
    closing = _closing(in_tool.mean(axis=1))
    along = in_tool[..., :2] @ closing
    left = along.mean(axis=1) < 0
    if left.all() or not left.any():
        return None
    pads = np.abs(in_tool[..., 2]).min(axis=1) < PADS_M
    if not (pads & left).any() or not (pads & ~left).any():
        pads = np.ones(len(geoms), dtype=bool)
    inner_left, inner_right = along[pads & left].max(), along[pads & ~left].min()
    across = in_tool[pads][..., :2] @ np.array([-closing[1], closing[0]])
    outside = max(inner_left - along[left].min(), along[~left].max() - inner_right)
    return Fingers(
        float(inner_right - inner_left),
        float(outside),
        float(2 * np.abs(across).max()),
        float(in_tool[..., 2].max()),
        closing,
    )


def _closing(middles: Float[Array, "n 3"]) -> Float[Array, "2"]:
    """The direction across the tool's z in which the fingers lie apart."""
    flat = middles[:, :2] - middles[:, :2].mean(axis=0)
    direction = np.linalg.svd(flat)[2][0]
    # Along x where that is nearly so, and then towards +x.
    return direction if direction[0] >= 0 else -direction


def _finger_geoms(model: MjModel, prefix: str, joint_ids: list[int]) -> Array:
    own = set(joint_ids)
    hand = int(model.site(prefix + "tool").bodyid[0])
    moved = []
    for body in range(1, model.nbody):
        line, under = body, False
        others = False
        while line:
            first, count = int(model.body_jntadr[line]), int(model.body_jntnum[line])
            others = others or bool(set(range(first, first + count)) - own)
            line = int(model.body_parentid[line])
            if line == _carrier(model, hand, own):
                under = True
                break
        if under and others:
            moved.append(body)
    geoms = np.flatnonzero(np.isin(model.geom_bodyid, moved))
    solid = geoms[(model.geom_contype[geoms] | model.geom_conaffinity[geoms]) > 0]
    return solid if len(solid) else geoms


def _carrier(model: MjModel, hand: int, own: set[int]) -> int:
    """The body that the last of the arm's own joints moves."""
    while hand:
        first, count = int(model.body_jntadr[hand]), int(model.body_jntnum[hand])
        if set(range(first, first + count)) & own:
            return hand
        hand = int(model.body_parentid[hand])
    return 0
