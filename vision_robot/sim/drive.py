"""The drives of an arm in a MuJoCo model: joints by their servos, and the gripper by its gap."""

from typing import Any, Self, TypeAlias

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.sim.jaws import Jaws
from vision_robot.types import Array, Float

__all__ = ["Drive"]

MjModel: TypeAlias = Any
MjData: TypeAlias = Any


class Drive:
    """Joints between the world and the site "tool", and what else the arm's actuators move: the gripper."""

    def __init__(self, mj: Any, model: MjModel, prefix: str):
        self._prefix = prefix
        self.joint_ids = _chain(mj, model, int(model.site(prefix + "tool").bodyid[0]))
        self.joint_names = tuple(model.joint(i).name.removeprefix(prefix) for i in self.joint_ids)
        self._qpos = np.array([model.jnt_qposadr[i] for i in self.joint_ids])
        self._qvel = np.array([model.jnt_dofadr[i] for i in self.joint_ids])
        moved = {
            k: int(model.actuator_trnid[k, 0])
            for k in range(model.nu)
            if model.actuator_trntype[k] == mj.mjtTrn.mjTRN_JOINT.value
        }
        # A servo's force falls with the length; a motor's does not, and holds nothing.
        servos = {joint: k for k, joint in moved.items() if model.actuator_biasprm[k, 1] < 0}
        self._servos = np.array([servos.get(i, -1) for i in self.joint_ids])
        others = [k for k in range(model.nu) if moved.get(k) not in self.joint_ids]
        self._gripper = others[0] if others and model.actuator_biasprm[others[0], 1] < 0 else None
        self._jaws = (
            None if self._gripper is None else Jaws.of(mj, model, prefix, self.joint_ids, self._gripper)
        )
        limits = np.where(model.jnt_limited[self.joint_ids, None], model.jnt_range[self.joint_ids], np.inf)
        self.limits = np.where(np.isinf(limits), [-np.inf, np.inf], limits)

    @classmethod
    def of(cls, mj: Any, model: MjModel, prefix: str) -> Self | None:
        """The drive of the arm whose names begin with `prefix`; None where there is none."""
        found = mj.mj_name2id(model, mj.mjtObj.mjOBJ_SITE.value, prefix + "tool") >= 0
        return cls(mj, model, prefix) if found else None

    def joints(self, data: MjData) -> Float[Array, "n"]:
        """Joint values [m, rad]."""
        return data.qpos[self._qpos].copy()

    def rates(self, data: MjData) -> Float[Array, "n"]:
        """Joint velocities [m/s, rad/s]."""
        return data.qvel[self._qvel].copy()

    def opening_m(self, data: MjData) -> float:
        """Gap between the fingers."""
        if self._gripper is None:
            return float("nan")
        return self._grip().gap_m(float(data.actuator_length[self._gripper]))

    def grip_n(self, data: MjData) -> float:
        """Force of the gripper's actuator; negative closes."""
        return float("nan") if self._gripper is None else float(data.actuator_force[self._gripper])

    def opening_limits_m(self, model: MjModel) -> tuple[float, float]:
        """Least and greatest gap that can be commanded."""
        if self._gripper is None:
            return float("nan"), float("nan")
        del model
        return self._grip().limits_m

    def command(self, data: MjData, joints: Float[Array, "n"] | None, opening_m: float | None) -> None:
        """Set what the servos shall hold from now on; None leaves it as it was."""
        if joints is not None:
            if (self._servos < 0).any():
                bare = [name for name, k in zip(self.joint_names, self._servos, strict=True) if k < 0]
                raise BadParameter("arm", bare, "an arm with a position actuator for every joint")
            data.ctrl[self._servos] = self.checked(joints)
        if opening_m is not None:
            if self._gripper is None:
                raise BadParameter("opening of the gripper", opening_m, "left out: this arm has no gripper")
            data.ctrl[self._gripper] = self._grip().command(opening_m)

    def put(self, data: MjData, joints: Float[Array, "n"], rates: Float[Array, "n"] | None = None) -> None:
        """Put the joints there at once, at rest or at `rates`, and have the servos hold them."""
        data.qpos[self._qpos] = self.checked(joints)
        data.qvel[self._qvel] = 0 if rates is None else rates
        driven = self._servos >= 0
        data.ctrl[self._servos[driven]] = np.asarray(joints, dtype=float)[driven]

    def put_opening(self, model: MjModel, data: MjData, opening_m: float) -> None:
        """Put the fingers there at once, each having its share of the gap, and have them held."""
        self.command(data, None, opening_m)
        assert self._gripper is not None
        self._grip().put(model, data, opening_m)

    def checked(self, joints: Float[Array, "n"]) -> Float[Array, "n"]:
        """The joint values, if they are as many as there are joints and are numbers."""
        values = np.asarray(joints, dtype=float)
        if values.shape != (len(self.joint_names),) or not np.isfinite(values).all():
            raise BadParameter(
                "joint values",
                values.tolist(),
                f"{len(self.joint_names)} numbers: {', '.join(self.joint_names)}",
            )
        return values

    def _grip(self) -> Jaws:
        if self._jaws is None:
            raise BadParameter("gripper", "none", "an arm whose fingers have a position actuator")
        return self._jaws


def _chain(mj: Any, model: MjModel, body: int) -> list[int]:
    """Sliding and turning joints from the world out to `body`."""
    joints: list[int] = []
    while body > 0:
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        joints = [*range(first, first + count), *joints]
        body = int(model.body_parentid[body])
    moving = (mj.mjtJoint.mjJNT_SLIDE.value, mj.mjtJoint.mjJNT_HINGE.value)
    return [i for i in joints if model.jnt_type[i] in moving]
