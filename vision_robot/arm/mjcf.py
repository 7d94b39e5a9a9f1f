"""MJCF as MuJoCo itself understands it: from its compiled model to a serial chain."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vision_robot.arm.model import Arm, one_of
from vision_robot.arm.model_size import refuse_oversized
from vision_robot.errors import BadArm
from vision_robot.geometry import SE3, SerialChain
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from mujoco import MjModel  # pyright: ignore[reportAttributeAccessIssue]

__all__ = ["chain_of_model", "read_mjcf"]

TOOL_NAMES = ("tool", "attachment_site", "grip_site", "ee_site", "end_effector", "pinch")
WRIST_NAME = "wrist"


def read_mjcf(
    path: Path, *, tool: str | None = None, wrist: str | None = None, base: str | None = None
) -> Arm:
    """The arm of an MJCF file; `tool` and `wrist` are sites or bodies, `base` is a body.

    Read by MuJoCo, so that defaults, includes and angle conventions mean what they mean there.
    Raises BadArm.
    """
    return chain_of_model(compiled(path), path, tool=tool, wrist=wrist, base=base)


def compiled(path: Path) -> "MjModel":
    """MuJoCo's compiled model; without its shapes where only those cannot be had. Raises BadArm."""
    from vision_robot.sim.gl import load_mujoco

    refuse_oversized(path)
    mujoco = load_mujoco(rendering=False)
    # Not only ValueError: what MuJoCo's compiler does not foresee comes as RuntimeError.
    try:
        return mujoco.MjModel.from_xml_path(str(path))
    except (ValueError, RuntimeError, MemoryError) as error:
        why = " ".join(str(error).split())
    try:
        # Meshes often stay behind when a model is passed on; kinematics need none.
        spec = mujoco.MjSpec.from_file(str(path))
        for shape in (*spec.geoms, *spec.skins, *spec.meshes, *spec.hfields, *spec.materials, *spec.textures):
            spec.delete(shape)
        spec.compiler.boundmass = spec.compiler.boundinertia = 1e-3
        return spec.compile()
    except (ValueError, RuntimeError, MemoryError):
        raise BadArm(path, why) from None


def chain_of_model(
    model: "MjModel",
    path: Path,
    *,
    tool: str | None = None,
    wrist: str | None = None,
    base: str | None = None,
) -> Arm:
    """The serial chain from base to tool in a compiled model, `path` being named in errors."""
    placed = (model.body_pos, model.body_quat, model.jnt_pos, model.jnt_axis, model.site_pos, model.site_quat)
    if not all(np.isfinite(numbers).all() for numbers in (*placed, model.qpos0, model.jnt_range)):
        raise BadArm(path, "a place, an axis or a limit in it is not a finite number")
    sites = [model.site(i).name for i in range(model.nsite)]
    bodies = [model.body(i).name for i in range(model.nbody)]
    if tool is None or tool not in bodies:
        tool = one_of(path, "site", tool, sites, TOOL_NAMES)
    body, tool_in_body = _frame(model, tool, sites)
    to_tool = _ancestors(model, body)
    moved = [b for b in to_tool if model.body_jntnum[b]]
    if not moved:
        raise BadArm(path, f"no joint moves {tool!r}")
    base_id = _base(model, path, base, bodies, moved[0])
    joints = [
        j for b in moved for j in range(model.body_jntadr[b], model.body_jntadr[b] + model.body_jntnum[b])
    ]
    if base_id not in [0, *to_tool] or (
        base_id in moved or any(m in _ancestors(model, base_id) for m in moved)
    ):
        raise BadArm(path, f"body {base!r} is no base: it must carry the first joint and stand still")
    _refuse_what_is_not_serial(model, path, joints)
    links, link = [], SE3.identity()
    for b in to_tool[to_tool.index(base_id) + 1 if base_id else 0 :]:
        link = link @ _pose(model.body_pos[b], model.body_quat[b])
        for j in _joints_of_body(model, b):
            anchor = SE3(np.eye(3), model.jnt_pos[j])
            links.append(link @ anchor)
            # The file's pose is that at qpos0, the joint's `ref`.
            link = _motion(model, j, -model.qpos0[model.jnt_qposadr[j]]) @ anchor.inverse()
    last_from_tool = link @ tool_in_body
    wrist_in_body = _wrist(model, path, wrist, sites, body, moved[-1])
    last_from_wrist = link @ wrist_in_body
    chain = SerialChain(
        joint_names=tuple(_name(model.joint(j).name, "joint", j) for j in joints),
        slides=np.array([model.jnt_type[j] == SLIDE for j in joints]),
        axes=np.array([model.jnt_axis[j] for j in joints]),
        link_from_joint=SE3(
            np.array([link.rotation for link in links]), np.array([link.translation for link in links])
        ),
        last_from_wrist=last_from_wrist,
        limits=np.array([model.jnt_range[j] if model.jnt_limited[j] else (-np.inf, np.inf) for j in joints]),
        wrist_from_tool=last_from_wrist.inverse() @ last_from_tool,
    )
    name = model.names[: model.names.index(b"\0")].decode() or path.stem
    return Arm(name, chain, base=bodies[base_id] or "world", tool=tool)


FREE, BALL, SLIDE, HINGE = range(4)
"""MuJoCo's mjtJoint."""


def _name(name: str, kind: str, index: int) -> str:
    return name or f"{kind}{index}"


def _joints_of_body(model: "MjModel", body: int) -> range:
    return range(model.body_jntadr[body], model.body_jntadr[body] + model.body_jntnum[body])


def _pose(pos: Float[Array, "3"], quat: Float[Array, "4"]) -> SE3:
    w, x, y, z = quat / np.linalg.norm(quat)
    rotation = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return SE3(np.array(rotation), pos)


def _motion(model: "MjModel", joint: int, value: float) -> SE3:
    along = value * model.jnt_axis[joint]
    still = np.zeros(3)
    return SE3.from_rotvec(still, along) if model.jnt_type[joint] == SLIDE else SE3.from_rotvec(along, still)


def _ancestors(model: "MjModel", body: int) -> list[int]:
    """Bodies from the world's child down to `body`."""
    line: list[int] = []
    while body:
        line.append(body)
        body = int(model.body_parentid[body])
    return line[::-1]


def _frame(model: "MjModel", name: str, sites: list[str]) -> tuple[int, SE3]:
    """Body that carries a site (or is named so), and the pose in it."""
    if name in sites:
        site = model.site(name).id
        return int(model.site_bodyid[site]), _pose(model.site_pos[site], model.site_quat[site])
    return int(model.body(name).id), SE3.identity()


def _wrist(
    model: "MjModel", path: Path, wrist: str | None, sites: list[str], tool_body: int, last: int
) -> SE3:
    """Pose of the wrist in the tool's body: the frame named, a site "wrist", or the last moved body."""
    bodies = [model.body(i).name for i in range(model.nbody)]
    if wrist is None and WRIST_NAME in sites:
        wrist = WRIST_NAME
    if wrist is not None:
        if wrist not in bodies:
            one_of(path, "site", wrist, sites, ())
        body, pose = _frame(model, wrist, sites)
    else:
        body, pose = last, SE3.identity()
    line = _ancestors(model, body)
    if last not in line or any(model.body_jntnum[b] for b in line[line.index(last) + 1 :]):
        raise BadArm(path, f"{wrist!r} is no wrist: it must be fixed to the last joint's body")
    down = _fixed_pose(model, line[line.index(last) + 1 :]) @ pose
    return _fixed_pose(model, _ancestors(model, tool_body)[len(_ancestors(model, last)) :]).inverse() @ down


def _fixed_pose(model: "MjModel", bodies: list[int]) -> SE3:
    pose = SE3.identity()
    for b in bodies:
        pose = pose @ _pose(model.body_pos[b], model.body_quat[b])
    return pose


def _base(model: "MjModel", path: Path, base: str | None, bodies: list[str], first: int) -> int:
    if base is None:
        return int(model.body_parentid[first])
    if base not in bodies:
        raise BadArm(path, f"it has no body {base!r}; it has {', '.join(name for name in bodies if name)}")
    return bodies.index(base)


def _refuse_what_is_not_serial(model: "MjModel", path: Path, joints: list[int]) -> None:
    """Raise BadArm, naming it, for a joint or constraint that makes the arm no serial chain."""
    for j in joints:
        name = _name(model.joint(j).name, "joint", j)
        if model.jnt_type[j] in (FREE, BALL):
            kind = "a free joint" if model.jnt_type[j] == FREE else "a ball joint"
            raise BadArm(
                path, f"{name!r} is {kind}: only joints that slide or turn about one axis can be solved"
            )
    for e in range(model.neq):
        held = _held_joints(model, e) & set(joints)
        if held and model.eq_active0[e]:
            names = ", ".join(repr(_name(model.joint(j).name, "joint", j)) for j in sorted(held))
            label = _name(model.equality(e).name, "equality ", e)
            raise BadArm(
                path,
                f"constraint {label!r} closes a loop over joint(s) {names}: only an open chain, each joint "
                "free by itself, can be solved",
            )


def _held_joints(model: "MjModel", equality: int) -> set[int]:
    """Joints that an equality constraint ties to each other, to a tendon or to the world."""
    kind = int(model.eq_type[equality])
    one, two = int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])
    connect, weld, joint, tendon = 0, 1, 2, 3
    if kind == joint:
        return {j for j in (one, two) if j >= 0}
    if kind == tendon:
        return {j for t in (one, two) if t >= 0 for j in _joints_of_tendon(model, t)}
    if kind not in (connect, weld):
        return set()
    if int(model.eq_objtype[equality]) == SITE:
        one, two = (int(model.site_bodyid[s]) for s in (one, two))
    if any(model.body_mocapid[b] >= 0 for b in (one, two)):
        return set()  # a handle for the mouse or a controller, no part of the arm
    differ = set(_ancestors(model, one)) ^ set(_ancestors(model, max(two, 0)))
    return {j for j in range(model.njnt) if int(model.jnt_bodyid[j]) in differ}


SITE = 6
"""MuJoCo's mjOBJ_SITE."""


def _joints_of_tendon(model: "MjModel", tendon: int) -> set[int]:
    first, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    is_joint = 1
    wraps: Any = range(first, first + count)
    return {int(model.wrap_objid[w]) for w in wraps if int(model.wrap_type[w]) == is_joint}
