"""From what a gripper's actuator is told to the gap between its fingers, and back."""

from dataclasses import dataclass
from typing import Any, Self, TypeAlias

import numpy as np

from vision_robot.sim.fingers import fingers_of
from vision_robot.types import Array, Float

__all__ = ["Jaws"]

MjModel: TypeAlias = Any
MjData: TypeAlias = Any

JOINT, TENDON = 0, 3
"""MuJoCo's mjTRN_JOINT and mjTRN_TENDON."""

POINTS = 9
"""At which the gap is measured in a model that does not tell it."""


@dataclass(frozen=True)
class Jaws:
    """A position servo that moves fingers: lengths of its transmission and gaps that go with them."""

    actuator: int
    lengths: Float[Array, "k"]
    """Rising."""
    gaps_m: Float[Array, "k"]
    shares: dict[int, tuple[float, float]]
    """Finger joint -> its value where the length is zero, and how much of the length it takes."""
    gain: float
    bias: tuple[float, float]
    """The servo's force is gain * command + bias[0] + bias[1] * length."""

    @classmethod
    def of(cls, mj: Any, model: MjModel, prefix: str, joint_ids: list[int], actuator: int) -> Self:
        """The jaws of an actuator; a number "gap_at_zero" in the file stands before what its shapes say."""
        gain, (b0, b1) = float(model.actuator_gainprm[actuator, 0]), model.actuator_biasprm[actuator, :2]
        shares = _shares(mj, model, actuator)
        told = mj.mj_name2id(model, mj.mjtObj.mjOBJ_NUMERIC.value, prefix + "gap_at_zero")
        low, high = sorted((-(gain * model.actuator_ctrlrange[actuator] + b0) / b1).tolist())
        lengths = np.linspace(low, high, POINTS)
        jaws = cls(actuator, lengths, lengths, shares, gain, (float(b0), float(b1)))
        if told >= 0:
            lengths = lengths[[0, -1]]
            gaps = lengths + float(model.numeric_data[model.numeric_adr[told]])
        else:
            gaps = _measured(mj, model, prefix, joint_ids, jaws)
        return cls(actuator, lengths, gaps, shares, gain, (float(b0), float(b1)))

    @property
    def limits_m(self) -> tuple[float, float]:
        """Least and greatest gap that can be commanded."""
        return float(self.gaps_m.min()), float(self.gaps_m.max())

    def gap_m(self, length: float) -> float:
        """The gap at a length of the transmission; on in a straight line past its range."""
        steps = np.diff(self.gaps_m) / np.diff(self.lengths)
        if length < self.lengths[0]:
            return float(self.gaps_m[0] + (length - self.lengths[0]) * steps[0])
        if length > self.lengths[-1]:
            return float(self.gaps_m[-1] + (length - self.lengths[-1]) * steps[-1])
        return float(np.interp(length, self.lengths, self.gaps_m))

    def command(self, gap_m: float) -> float:
        """What the actuator has to be told for that gap."""
        return (-self.bias[1] * self._length(gap_m) - self.bias[0]) / self.gain

    def put(self, model: MjModel, data: MjData, gap_m: float) -> None:
        """Put the fingers there at once."""
        self.bend(model, data, self._length(gap_m))

    def bend(self, model: MjModel, data: MjData, length: float) -> None:
        """Put the finger joints where the transmission has that length."""
        for joint, (zero, share) in self.shares.items():
            data.qpos[model.jnt_qposadr[joint]] = zero + share * length
            data.qvel[model.jnt_dofadr[joint]] = 0

    def _length(self, gap_m: float) -> float:
        order = np.argsort(self.gaps_m)
        gaps, lengths = self.gaps_m[order], self.lengths[order]
        if gap_m <= gaps[0] or gap_m >= gaps[-1]:
            k = 0 if gap_m <= gaps[0] else len(gaps) - 2
            slope = (lengths[k + 1] - lengths[k]) / (gaps[k + 1] - gaps[k]) if gaps[k + 1] > gaps[k] else 0.0
            return float(lengths[k] + (gap_m - gaps[k]) * slope)
        return float(np.interp(gap_m, gaps, lengths))


def _measured(mj: Any, model: MjModel, prefix: str, joint_ids: list[int], jaws: Jaws) -> Float[Array, "k"]:
    """Gaps between the fingers' shapes at the lengths; the lengths themselves where there are no fingers."""
    data, gaps = mj.MjData(model), []
    for length in jaws.lengths:
        jaws.bend(model, data, float(length))
        mj.mj_kinematics(model, data)
        fingers = fingers_of(model, data, prefix, joint_ids)
        if fingers is None:
            return jaws.lengths
        gaps.append(fingers.gap_m)
    return np.array(gaps)


def _shares(mj: Any, model: MjModel, actuator: int) -> dict[int, tuple[float, float]]:
    """What of the length each finger joint takes, those that are coupled by equations included."""
    kind, target = int(model.actuator_trntype[actuator]), int(model.actuator_trnid[actuator, 0])
    if kind == JOINT:
        shares = {target: (0.0, 1.0 / float(model.actuator_gear[actuator, 0]))}
    elif kind == TENDON:
        first, count = int(model.tendon_adr[target]), int(model.tendon_num[target])
        wraps = [
            i for i in range(first, first + count) if model.wrap_type[i] == mj.mjtWrap.mjWRAP_JOINT.value
        ]
        weights = np.array([float(model.wrap_prm[i]) for i in wraps])
        each = weights / max(float(weights @ weights), 1e-12)
        shares = {int(model.wrap_objid[i]): (0.0, float(w)) for i, w in zip(wraps, each, strict=True)}
    else:
        return {}
    for _ in range(2):  # a joint may be coupled to a coupled one
        for e in range(model.neq):
            if model.eq_type[e] != mj.mjtEq.mjEQ_JOINT.value:
                continue
            one, two = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
            c0, c1 = model.eq_data[e, :2].tolist()
            if two in shares and one not in shares:
                zero, share = shares[two]
                shares[one] = (c0 + c1 * zero, c1 * share)
            elif one in shares and two not in shares and two >= 0 and c1:
                zero, share = shares[one]
                shares[two] = ((zero - c0) / c1, share / c1)
    return shares
