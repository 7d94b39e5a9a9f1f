"""What lives in a cell: the things on its table and the arm."""

from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

import vision_robot
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot.sim.cell_design import ArmMount, Colour, Item
from vision_robot.sim.cell_names import ARM, COLLIDERS, ITEM, LABEL, LABEL_THICKNESS_M, MOVING
from vision_robot.sim.placing import put, resting
from vision_robot.sim.shapes import Collider, Shape, shape_named

__all__ = ["add_arm", "add_item"]

MjSpec: TypeAlias = Any
MjsBody: TypeAlias = Any

OWN_ARM = Path(vision_robot.__file__).parent / "arm" / "models" / "column_arm.xml"


def add_item(mj: Any, spec: MjSpec, item: Item, base_from_station: SE3) -> None:
    """A body with a drawn mesh for each part, and invisible colliders that carry the mass."""
    shape = shape_named(item.shape, item.size_m, item.colour)
    body = spec.worldbody.add_body(name=ITEM + item.name, mocap=item.path is not None)
    start = np.array([item.x_m, item.y_m, item.above_m, item.yaw_rad])
    put(body, base_from_station @ resting(item, start if item.path is None else item.path.at(0.0)))
    if item.path is None and not item.fixed:
        body.add_freejoint(name=ITEM + item.name)
    for k, part in enumerate(shape.parts):
        name = f"{ITEM}{item.name}/{k}"
        spec.add_mesh(name=name, uservert=part.corners.ravel())
        spec.add_material(name=name, rgba=[*part.colour, 1], specular=item.glossy, shininess=0.5)
        body.add_geom(
            name=name,
            type=mj.mjtGeom.mjGEOM_MESH,
            meshname=name,
            material=name,
            group=MOVING,
            contype=0,
            conaffinity=0,
            mass=0,
        )
    for collider in shape.colliders:
        _add_collider(mj, spec, body, item, shape, collider)


def _add_collider(mj: Any, spec: MjSpec, body: MjsBody, item: Item, shape: Shape, collider: Collider) -> None:
    name = f"{ITEM}{item.name}/solid"
    kinds = {
        "box": mj.mjtGeom.mjGEOM_BOX,
        "capsule": mj.mjtGeom.mjGEOM_CAPSULE,
        "mesh": mj.mjtGeom.mjGEOM_MESH,
    }
    if collider.kind == "mesh":
        spec.add_mesh(name=name, uservert=shape.hull.ravel())
    geom = body.add_geom(
        name=name,
        type=kinds[collider.kind],
        meshname=name if collider.kind == "mesh" else "",
        pos=collider.middle,
        quat=[np.sqrt(0.5), 0, np.sqrt(0.5), 0] if collider.along_x else [1, 0, 0, 0],
        group=COLLIDERS,
        density=shape.density,
        condim=6,
        friction=[0.5, 0.003, 0.0002],
        solref=[0.005, 1],
        solimp=[0.95, 0.99, 0.0005, 0.5, 2],
    )
    if collider.size:
        geom.size[: len(collider.size)] = collider.size


def add_arm(mj: Any, spec: MjSpec, mount: ArmMount) -> None:
    """Attach the arm's bodies and what goes with them; hang the label on what carries the tool."""
    path = Path(mount.mjcf or OWN_ARM)
    try:
        arm = mj.MjSpec.from_file(str(path))
    except (OSError, ValueError) as error:
        raise BadParameter("arm", str(path), f"an MJCF file that MuJoCo can read ({error})") from error
    tool = arm.site(mount.tool)
    if tool is None:
        raise BadParameter("arm", str(path), f'an MJCF file with a site "{mount.tool}" between the fingers')
    if mount.tool != "tool" or mount.tool_turn_rad:
        tool = _add_tool(mj, arm, tool, mount.tool_turn_rad)
    if mount.balanced:
        for body in arm.bodies:
            body.gravcomp = 1
    if mount.label is not None:
        _add_label(mj, arm, tool.parent, mount, mount.label)
    spec.attach(arm, frame=spec.worldbody.add_frame(), prefix=ARM)


def _add_tool(mj: Any, arm: MjSpec, site: Any, turn_rad: float) -> Any:
    """A site "tool" at another site's place, turned about its z; one of that name gives it up."""
    if site.alt.type != mj.mjtOrientation.mjORIENTATION_QUAT:
        raise BadParameter("tool", site.name, "a site whose orientation is a quat")
    turned = np.zeros(4)
    half = turn_rad / 2
    mj.mju_mulQuat(turned, np.asarray(site.quat), np.array([np.cos(half), 0.0, 0.0, np.sin(half)]))
    body, position = site.parent, np.array(site.pos)
    named = arm.site("tool")
    if named is not None:
        named.name = "tool of the file"
    return body.add_site(name="tool", pos=position, quat=turned, size=[0.004] * 3, rgba=[0, 0, 0, 0])


def _add_label(mj: Any, arm: MjSpec, hand: MjsBody, mount: ArmMount, colour: Colour) -> None:
    """A coloured plate on a bracket, facing away from where the tool points."""
    site = arm.site("label")
    if site is None:
        raise BadParameter("arm", str(mount.mjcf), 'an MJCF file with a site "label" to hang the label on')
    half = [mount.label_m[0] / 2, mount.label_m[1] / 2, LABEL_THICKNESS_M / 2]
    plate = hand.add_body(name=LABEL, pos=site.pos, quat=site.quat, gravcomp=1)
    if site.alt.type != mj.mjtOrientation.mjORIENTATION_QUAT:
        plate.alt = site.alt
    plate.add_geom(
        name=LABEL,
        type=mj.mjtGeom.mjGEOM_BOX,
        size=half,
        rgba=[*colour, 1],
        mass=0.004,
        contype=0,
        conaffinity=0,
        group=MOVING,
    )
