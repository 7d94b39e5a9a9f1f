"""Whether the gripper really has a thing: contacts and heights of the physics, nothing believed."""

import numpy as np

from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_model import ARM, ITEM

__all__ = ["held_by", "lifted_m"]


def held_by(cell: Cell, name: str) -> frozenset[str]:
    """Bodies of the arm that touch the thing."""
    model, data = cell.model, cell.data
    mine = int(model.body(ITEM + name).id)
    touching = set()
    for contact in data.contact[: data.ncon]:
        bodies = model.geom_bodyid[contact.geom]
        if mine in bodies:
            other = int(bodies[0] if bodies[1] == mine else bodies[1])
            if model.body(other).name.startswith(ARM):
                touching.add(model.body(other).name.removeprefix(ARM))
    return frozenset(touching)


def lifted_m(cell: Cell, name: str) -> float:
    """How high the lowest point of the thing is over the table."""
    index = cell.tracked.index(name)
    corners = cell.station_from(name).apply(np.asarray(cell.hulls[index], dtype=float))
    return float(corners[:, 2].min())
