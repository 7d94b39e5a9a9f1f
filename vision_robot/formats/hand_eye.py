"""The file of a hand-eye calibration, our own JSON, which reads as a camera file too.

Keys: schema, setup, camera, wrist_from_cam and base_from_board (or base_from_cam and wrist_from_board),
hand_eye_covariance, arm_noise, and arm where its links were corrected.
"""

import json
from pathlib import Path

import numpy as np

from vision_robot.files import write_text
from vision_robot.formats import native
from vision_robot.formats.covariance import covariance_object, read_covariance
from vision_robot.formats.parse import parse_json
from vision_robot.formats.pose import pose_object, read_pose
from vision_robot.formats.source import open_source
from vision_robot.formats.tree import Tree
from vision_robot.geometry import SE3, SerialChain
from vision_robot.geometry.hand_eye import MOUNTS, HandEye

__all__ = ["SCHEMA", "arm_object", "corrected_chain", "hand_eye_object", "read_hand_eye", "write_hand_eye"]

SCHEMA = "vr.hand-eye/1"


def hand_eye_object(found: HandEye, arm: SerialChain | None = None) -> dict[str, object]:
    """The keys of the file, without its schema; `arm` is the chain with its links as found."""
    tree: dict[str, object] = {
        "setup": found.setup,
        "camera": native.camera_object(found.camera),
        found.mount_name: pose_object(found.mount_from_cam),
        found.far_name: pose_object(found.far_from_board),
        "hand_eye_covariance": covariance_object(found.parameter_names, found.covariance),
        "arm_noise": {"turn_rad": found.arm_turn, "shift_m": found.arm_shift_m},
    }
    return tree if arm is None else {**tree, "arm": arm_object(arm)}


def arm_object(arm: SerialChain) -> dict[str, object]:
    """Links of a chain as they were found."""
    links = arm.link_from_joint
    return {
        "joint_names": list(arm.joint_names),
        "link_from_joint": [pose_object(links[i]) for i in range(len(arm))],
        "last_from_wrist": pose_object(arm.last_from_wrist),
    }


def write_hand_eye(found: HandEye, path: Path | str, arm: SerialChain | None = None) -> None:
    """Write the file, whole or not at all."""
    write_text(path, json.dumps({"schema": SCHEMA, **hand_eye_object(found, arm)}, indent=1) + "\n")


def read_hand_eye(path: Path | str) -> HandEye:
    """Read such a file; raises BadCameraFile, naming the key and what was expected there."""
    source = open_source(path)
    tree = parse_json(source)
    setup = tree.get("setup")
    if setup.text() not in MOUNTS:
        raise setup.bad(f"{' or '.join(MOUNTS)} expected")
    (camera,) = native.read(source).values()
    mount, far = MOUNTS[setup.text()]
    noise = tree.find("arm_noise")
    blank = HandEye(
        setup=setup.text(),
        camera=camera,
        mount_from_cam=read_pose(tree.get(f"{mount}_from_cam")),
        far_from_board=read_pose(tree.get(f"{far}_from_board")),
        covariance=np.zeros((12, 12)),
    )
    return HandEye(
        setup=blank.setup,
        camera=camera,
        mount_from_cam=blank.mount_from_cam,
        far_from_board=blank.far_from_board,
        covariance=read_covariance(tree.get("hand_eye_covariance"), blank.parameter_names),
        arm_turn=noise.get("turn_rad").number() if noise else 0.0,
        arm_shift_m=noise.get("shift_m").number() if noise else 0.0,
    )


def corrected_chain(path: Path | str, nominal: SerialChain) -> SerialChain:
    """The chain with the links that a hand-eye calibration found; raises BadCameraFile where it has none."""
    from dataclasses import replace

    source = open_source(path)
    arm = parse_json(source).get("arm")
    names = arm.get("joint_names")
    if names.value != list(nominal.joint_names):
        raise names.bad(f"the arm's joints {', '.join(nominal.joint_names)} expected")
    listed = arm.get("link_from_joint")
    items = listed.value if isinstance(listed.value, list) else []
    if len(items) != len(nominal):
        raise listed.bad(f"{len(nominal)} poses expected")
    links = [read_pose(Tree(source, item, f"{listed.key}[{i}]")) for i, item in enumerate(items)]
    return replace(
        nominal,
        link_from_joint=SE3(
            np.stack([link.rotation for link in links]), np.stack([link.translation for link in links])
        ),
        last_from_wrist=read_pose(arm.get("last_from_wrist")),
    )
