"""Whether an arm touches itself or its surroundings, asked of MuJoCo."""

from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.arm.model_size import refuse_oversized
from vision_robot.errors import BadArm
from vision_robot.types import Array, Bool, Float

__all__ = ["free_of_collision"]


def free_of_collision(
    path: Path | str, joint_names: tuple[str, ...], q: Float[Array, "rows n"]
) -> Bool[Array, "rows"]:
    """Whether the model in an MJCF or URDF file touches nothing with its moving parts at each joint vector.

    What may touch what is as the file says (contype, conaffinity, excludes); joints not named stand where
    the file has them. Raises BadArm where the file has no such joints.
    """
    from vision_robot.sim.gl import load_mujoco

    mujoco = load_mujoco(rendering=False)
    refuse_oversized(Path(path))
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except (ValueError, RuntimeError, MemoryError) as error:
        raise BadArm(path, " ".join(str(error).split())) from error
    data = mujoco.MjData(model)
    known = {model.joint(j).name for j in range(model.njnt)}
    missing = [name for name in joint_names if name not in known]
    if missing:
        raise BadArm(path, f"it has no joint {missing[0]!r}; it has {', '.join(sorted(filter(None, known)))}")
    places = [int(model.joint(name).qposadr[0]) for name in joint_names]
    first = min(int(model.joint(name).bodyid[0]) for name in joint_names)
    carried = np.array([_is_under(model, body, first) for body in range(model.nbody)])
    free = np.empty(len(q), dtype=bool)
    for row, values in enumerate(q):
        data.qpos[places] = values
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        touching = data.contact.geom[data.contact.dist < 0]
        free[row] = not carried[model.geom_bodyid[touching]].any()
    return free


def _is_under(model: Any, body: int, top: int) -> bool:
    while body and body != top:
        body = int(model.body_parentid[body])
    return body == top
