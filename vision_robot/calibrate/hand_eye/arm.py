"""What the arm says: poses as given, or joint values with a geometry that may be corrected.

A real arm's links are not its drawing's. Every transform between joints is perturbed by a small turn
and shift in the joint's own frame. Most of these 6 n numbers cannot be told apart: a shift along a
hinge's axis can go into the link before or after it, errors of the first link into the pose of what is fixed
to the base, those of the last into what the wrist carries. Which combinations change the poses at all is
worked out from the chain itself, over its range of motion; the rest stay zero. For hinges and slides
that leaves 4 R + 2 P - 6 (Mooring, Roth & Driels 1991, with the two ends left out).
"""

from dataclasses import dataclass, field, replace

import numpy as np

from vision_robot.geometry import SE3, SerialChain, rotation_exp, skew
from vision_robot.types import Array, Float

__all__ = ["ArmGeometry", "GivenPoses", "GeometryTolerance", "link_jacobian"]

SAMPLES = 120
NEGLIGIBLE = 1e-6
"""Effect, as a part of the largest, below which a combination of link errors changes no pose."""


@dataclass(frozen=True)
class GivenPoses:
    """base_from_wrist of each view, taken as the arm's controller says it."""

    base_from_wrist: SE3

    @property
    def count(self) -> int:
        """How many unknowns of the arm's own there are."""
        return 0

    @property
    def values(self) -> Float[Array, "0"]:
        """Those unknowns."""
        return np.zeros(0)

    def jacobian(self) -> Float[Array, "n 6 0"]:
        """Turn, then shift of each pose per unknown, both in base axes."""
        return np.zeros((len(self.base_from_wrist), 6, 0))

    def moved(self, step: Float[Array, "0"]) -> "GivenPoses":  # noqa: ARG002 - nothing moves
        """After a step of the unknowns."""
        return self

    def keeping(self, views: Array) -> "GivenPoses":
        """Some of the views."""
        return GivenPoses(self.base_from_wrist[views])


@dataclass(frozen=True)
class GeometryTolerance:
    """What is believed of a link before any picture: one standard deviation of its errors."""

    turn: float = np.radians(0.5)
    shift_m: float = 2e-3


@dataclass(frozen=True)
class ArmGeometry:
    """Joint values of each view, a chain, and link errors ``V c`` with c ~ N(0, 1) before the data.

    `basis` (6 n, k) maps the unknowns to (turn [rad], shift [m]) of each link in turn.
    """

    chain: SerialChain
    joints: Float[Array, "views n"]
    basis: Float[Array, "m k"]
    values: Float[Array, "k"]
    nominal: SerialChain
    tolerance: GeometryTolerance = field(default_factory=GeometryTolerance)

    @classmethod
    def of(
        cls, chain: SerialChain, joints: Float[Array, "views n"], tolerance: GeometryTolerance | None = None
    ) -> "ArmGeometry":
        """All combinations of link errors that change a pose, none changed yet."""
        tolerance = tolerance or GeometryTolerance()
        basis = _basis(chain, joints, tolerance)
        return cls(chain, np.asarray(joints, dtype=float), basis, np.zeros(basis.shape[1]), chain, tolerance)

    @property
    def base_from_wrist(self) -> SE3:
        """Poses that the present geometry gives."""
        return self.chain.base_from_wrist(self.joints)

    @property
    def count(self) -> int:
        """How many unknowns of the arm's own there are."""
        return self.basis.shape[1]

    @property
    def link_errors(self) -> Float[Array, "n 6"]:
        """(turn [rad], shift [m]) of each link in its joint's frame."""
        return (self.basis @ self.values).reshape(-1, 6)

    def jacobian(self) -> Float[Array, "n 6 k"]:
        """Turn, then shift of each pose per unknown, both in base axes."""
        return link_jacobian(self.chain, self.joints) @ self.basis

    def moved(self, step: Float[Array, "k"]) -> "ArmGeometry":
        """After a step of the unknowns."""
        change = (self.basis @ step).reshape(-1, 6)
        links = self.chain.link_from_joint @ SE3(rotation_exp(change[:, :3]), change[:, 3:])
        return replace(self, chain=replace(self.chain, link_from_joint=links), values=self.values + step)

    def keeping(self, views: Array) -> "ArmGeometry":
        """Some of the views."""
        return replace(self, joints=self.joints[views])


def link_jacobian(chain: SerialChain, joints: Float[Array, "views n"]) -> Float[Array, "views 6 m"]:
    """Turn, then shift of the wrist in base axes, per (turn, shift) of each link in its joint's frame."""
    moved = chain.base_from_joints(joints)
    wrist = (moved[-1] @ chain.last_from_wrist).translation
    before = SE3.identity(len(joints))
    columns = []
    for i in range(len(chain)):
        joint = before @ chain.link_from_joint[i]
        R = joint.rotation
        arm = -skew(wrist - joint.translation) @ R
        turn = np.concatenate([R, arm], axis=1)
        shift = np.concatenate([np.zeros_like(R), R], axis=1)
        columns += [turn, shift]
        before = moved[i]
    return np.concatenate(columns, axis=2)


def _basis(
    chain: SerialChain, joints: Float[Array, "views n"], tolerance: GeometryTolerance
) -> Float[Array, "m k"]:
    """Combinations of link errors, one tolerance each, that no pose of base or wrist can stand for."""
    rng = np.random.default_rng(0)  # a fixed sample of the arm's range: the same arm, the same unknowns
    low = np.where(
        np.isfinite(chain.limits[:, 0]), chain.limits[:, 0], np.minimum(joints.min(axis=0), -np.pi)
    )
    high = np.where(
        np.isfinite(chain.limits[:, 1]), chain.limits[:, 1], np.maximum(joints.max(axis=0), np.pi)
    )
    q = rng.uniform(low, high, (SAMPLES, len(chain)))
    scale = np.tile([tolerance.turn] * 3 + [tolerance.shift_m] * 3, len(chain))
    pose = chain.base_from_wrist(q)
    rows = link_jacobian(chain, q) * scale
    R, t = pose.rotation, pose.translation
    zero, one = np.zeros_like(R), np.broadcast_to(np.eye(3), R.shape)
    # A small motion of the base, in base axes, and one of the wrist, in its own.
    base = np.concatenate([np.concatenate([one, zero], 2), np.concatenate([-skew(t), one], 2)], 1)
    wrist = np.concatenate([np.concatenate([R, zero], 2), np.concatenate([zero, R], 2)], 1)
    units = np.tile([1 / tolerance.turn] * 3 + [1 / tolerance.shift_m] * 3, SAMPLES)[:, None]
    ends = np.concatenate([base, wrist], axis=2).reshape(-1, 12) * units
    rows = rows.reshape(-1, rows.shape[2]) * units
    rows = rows - ends @ np.linalg.lstsq(ends, rows, rcond=None)[0]
    _, strength, Vt = np.linalg.svd(rows, full_matrices=False)
    kept = Vt[strength > NEGLIGIBLE * max(strength[0], 1e-300)]
    return scale[:, None] * kept.T
