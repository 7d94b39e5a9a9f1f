"""A serial arm as numbers: fixed transforms between joints that slide or turn."""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry.se3 import SE3, rotation_exp
from vision_robot.types import Array, Bool, Float

__all__ = ["SerialChain"]


@dataclass(frozen=True)
class SerialChain:
    """Links from the base {B} to the wrist {W}, joined by sliding and turning joints.

    Joint i sits at ``link_from_joint[i]`` in the link before it (link 0 is the base) and moves
    what follows along (slide) or about (hinge) its unit `axes[i]`; the wrist sits at
    `last_from_wrist` in what the last joint moves:
    ``base_from_wrist(q) = F_0 J_0(q_0) F_1 J_1(q_1) ... last_from_wrist``.
    Joint values are in metres or radians, and zero wherever the model says zero is. The tool
    {T} is carried by the wrist at `wrist_from_tool`.
    """

    joint_names: tuple[str, ...]
    slides: Bool[Array, "n"]
    axes: Float[Array, "n 3"]
    link_from_joint: SE3
    last_from_wrist: SE3
    limits: Float[Array, "n 2"]
    """Least and greatest value of each joint [m or rad]; infinite where there is none."""
    wrist_from_tool: SE3

    def __post_init__(self) -> None:
        n = len(self.joint_names)
        axes = np.asarray(self.axes, dtype=float).reshape(-1, 3)
        slides = np.asarray(self.slides, dtype=bool)
        limits = np.asarray(self.limits, dtype=float)
        if n == 0 or not len(axes) == len(slides) == len(limits) == len(self.link_from_joint) == n:
            counts = (n, len(axes), len(slides), len(limits), len(self.link_from_joint))
            raise BadParameter("chain: counts of joints", counts, "one or more, the same number of each")
        length = np.linalg.norm(axes, axis=1)
        if not (np.isfinite(axes).all() and (length > 0).all()):
            raise BadParameter("chain: joint axes", axes.tolist(), "finite and not zero")
        if not (limits[:, 0] <= limits[:, 1]).all():
            raise BadParameter("chain: joint limits", limits.tolist(), "pairs, the least first")
        object.__setattr__(self, "axes", axes / length[:, None])
        object.__setattr__(self, "slides", slides)
        object.__setattr__(self, "limits", limits)

    def __len__(self) -> int:
        return len(self.joint_names)

    def within_limits(self, q: Float[Array, "*batch n"], slack: float = 0.0) -> Bool[Array, "*batch"]:
        """Whether every joint lies inside its limits, or past them by no more than `slack`."""
        inside = (q >= self.limits[:, 0] - slack) & (q <= self.limits[:, 1] + slack)
        return np.all(inside, axis=-1)

    def base_from_wrist(self, q: Float[Array, "*batch n"]) -> SE3:
        """Pose of the wrist at joint values `q`."""
        return self.base_from_joints(q)[-1] @ self.last_from_wrist

    def base_from_tool(self, q: Float[Array, "*batch n"]) -> SE3:
        """Pose of the tool at joint values `q`."""
        return self.base_from_wrist(q) @ self.wrist_from_tool

    def base_from_joints(self, q: Float[Array, "*batch n"]) -> list[SE3]:
        """Frame of each joint in the base, after its own motion."""
        q = np.asarray(q, dtype=float)
        if q.shape[-1] != len(self):
            raise BadParameter("joint values", q.shape, f"{len(self)} in the last axis")
        pose, frames = SE3.identity(*q.shape[:-1]), []
        for i in range(len(self)):
            motion = q[..., i, None] * self.axes[i]
            still = np.zeros_like(motion)
            moved = SE3(rotation_exp(still), motion) if self.slides[i] else SE3(rotation_exp(motion), still)
            pose = pose @ self.link_from_joint[i] @ moved
            frames.append(pose)
        return frames

    def jacobian(self, q: Float[Array, "*batch n"]) -> Float[Array, "*batch 6 n"]:
        """Velocity of the tool point, then angular velocity, both in base axes, per joint velocity.

        The geometric Jacobian (Siciliano et al. 2009, section 3.1).
        """
        frames = self.base_from_joints(q)
        tip = (frames[-1] @ self.last_from_wrist @ self.wrist_from_tool).translation
        columns = []
        for axis, slides, frame in zip(self.axes, self.slides, frames, strict=True):
            along = frame.rotation @ axis
            turn = np.zeros_like(along) if slides else along
            move = along if slides else np.cross(along, tip - frame.translation)
            columns.append(np.concatenate([move, turn], axis=-1))
        return np.stack(columns, axis=-1)

    def with_tool(self, wrist_from_tool: SE3) -> "SerialChain":
        """The same arm carrying another tool."""
        return replace(self, wrist_from_tool=wrist_from_tool)
