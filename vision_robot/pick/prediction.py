"""What a pick will miss by, told before it is made: all covariances carried to the tool to first order."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from vision_robot.geometry import SE3, WorkPlane
from vision_robot.pick.episode import axis_angle
from vision_robot.pick.goal import station_from_grasp, upright
from vision_robot.pick.knowledge import STAGES, Knowledge
from vision_robot.pick.moments import Moments
from vision_robot.pick.rehearsal import Rehearsal
from vision_robot.pick.sighting import Seen, as_middle, sighting
from vision_robot.types import Array, Float

__all__ = ["predicted"]


def predicted(
    knowledge: Knowledge, seen: Seen, height_m: float, joints: Float[Array, "n"], rehearsal: Rehearsal
) -> Moments:
    """Expected squares of the miss at closing, open loop, by stage.

    Nothing true is used: camera and plane bring their joint covariance, the station that of the touched
    marks, tracker and servos what they showed when they were rehearsed. The arm's geometry is taken as
    drawn, unless `knowledge` says how well it is known.

    Args:
        knowledge: What is believed.
        seen: What the tracker said.
        height_m: Of the thing's axis over the table.
        joints: Joint values at which the fingers close.
        rehearsal: How tracker and servos err.
    """
    seen = as_middle(knowledge.plane, seen, height_m)
    nothing = np.zeros((len(joints), len(joints)))
    blocks = {
        "camera": knowledge.plane.known_camera.covariance,
        "pose": knowledge.plane.pose_covariance,
        "station": knowledge.station_covariance,
        "seen": rehearsal.seen_covariance,
        "arm": nothing if knowledge.joint_covariance is None else knowledge.joint_covariance,
        "servo": rehearsal.servo_covariance,
    }
    sizes = {name: len(block) for name, block in blocks.items()}
    ends = dict(zip(sizes, np.cumsum(list(sizes.values())), strict=True))
    at = {name: slice(ends[name] - size, ends[name]) for name, size in sizes.items()}
    covariance = np.zeros((ends["servo"], ends["servo"]))
    for name, block in blocks.items():
        covariance[at[name], at[name]] = block
    both = slice(at["camera"].start, at["pose"].stop)
    covariance[both, both] = knowledge.plane.covariance  # the cross terms that make their errors cancel

    def where(off: Float[Array, "q"]) -> Float[Array, "3"]:
        moved = _moved(knowledge, off[at["camera"]], off[at["pose"]], off[at["station"]])
        u, v, yaw = off[at["seen"]]
        turned = replace(seen, centroid_px=seen.centroid_px + np.array([u, v]), yaw_rad=seen.yaw_rad + yaw)
        goal = _goal(moved, turned, height_m)
        base_from_tool = knowledge.arm.chain.base_from_tool
        # The arm is not where its joints say, by the errors of its geometry and of its servos.
        astray = base_from_tool(joints).inverse() @ base_from_tool(joints + off[at["arm"]] + off[at["servo"]])
        tool = knowledge.base_from_station.inverse() @ goal @ astray
        return np.array([*tool.translation[:2], axis_angle(tool.rotation, 1)])

    jacobian = _derivative(where, np.sqrt(np.diag(covariance)))
    stage_of = {"camera": "calibration", "pose": "plane", "station": "plane", "seen": "tracking",
                "arm": "ik", "servo": "control"}  # fmt: skip
    belongs = np.zeros((len(STAGES), len(covariance)))
    for name, place in at.items():
        belongs[STAGES.index(stage_of[name]), place] = 1.0

    def by_stage(rows: Float[Array, "d q"]) -> Float[Array, "k k"]:
        return belongs @ ((rows.T @ rows) * covariance) @ belongs.T

    return Moments(STAGES, by_stage(jacobian[:2]), by_stage(jacobian[2:]))


def _moved(
    knowledge: Knowledge, camera: Float[Array, "p"], pose: Float[Array, "6"], station: Float[Array, "6"]
) -> Knowledge:
    plane = knowledge.plane
    other = WorkPlane.exact(
        plane.camera.with_parameters(plane.camera.parameters + camera),
        _perturbed(plane.cam_from_station, pose),
    )
    return replace(knowledge, plane=other, base_from_station=_perturbed(knowledge.base_from_station, station))


def _perturbed(pose: SE3, off: Float[Array, "6"]) -> SE3:
    """R <- Exp(w) R, t <- t + dt."""
    turn = SE3.from_rotvec(off[:3], np.zeros(3)).rotation
    return SE3(turn @ pose.rotation, pose.translation + off[3:])


def _goal(knowledge: Knowledge, seen: Seen, height_m: float) -> SE3:
    """base_from_tool that is asked for."""
    found = sighting(knowledge.plane, seen, height_m)
    grasp = station_from_grasp(found.position_m, found.yaw_rad, height_m)
    return upright(knowledge.base_from_station @ grasp)


def _derivative(
    function: Callable[[Float[Array, "q"]], Float[Array, "3"]], sigma: Float[Array, "q"]
) -> Float[Array, "3 q"]:
    """By central differences over one sigma, at which the first order has to hold; zero where sigma is."""
    columns = []
    for i, step in enumerate(sigma):
        off = np.zeros(len(sigma))
        off[i] = step
        if step <= 0:
            columns.append(np.zeros(3))
            continue
        ahead, behind = function(off), function(-off)
        change = ahead - behind
        change[2] = (change[2] + np.pi) % (2 * np.pi) - np.pi
        columns.append(change / (2 * step))
    return np.array(columns).T
