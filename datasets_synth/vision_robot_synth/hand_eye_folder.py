"""A hand-eye set on disk: frames/*.png, poses.csv, camera.json and truth.json."""

import json
from pathlib import Path

import cv2

from vision_robot.errors import UnwritableOutput
from vision_robot.files import write_bytes, write_text
from vision_robot.formats import write_camera
from vision_robot.formats.hand_eye import hand_eye_object
from vision_robot.geometry.hand_eye import HandEye
from vision_robot_synth.hand_eye import HandEyeSet

__all__ = ["pose_table_csv", "write_hand_eye_set"]

FRAME = "{}.png"


def write_hand_eye_set(made: HandEyeSet, folder: Path | str) -> None:
    """Write the set to an empty or missing folder; raises UnwritableOutput, MissingOpenGL."""
    import numpy as np

    folder = Path(folder)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise UnwritableOutput(folder, "it exists and holds something")
    for name, image in zip(made.names, made.images(), strict=True):
        _, png = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 1])
        write_bytes(folder / "frames" / FRAME.format(name.replace(" ", "_")), png.tobytes())
    write_text(folder / "poses.csv", pose_table_csv(made))
    write_camera(made.camera, folder / "camera.json")
    truth = HandEye(
        made.setup, made.camera, made.cell.mount_from_cam, made.cell.far_from_board, np.zeros((12, 12))
    )
    described = {"schema": "vr.hand-eye/1", "seed": made.seed, **hand_eye_object(truth, made.true_arm)}
    write_text(folder / "truth.json", json.dumps(described, indent=1) + "\n")


def pose_table_csv(made: HandEyeSet) -> str:
    """What the arm says of every view: picture, position, quaternion and joint values."""
    from vision_robot_synth.quaternions import quaternions

    arm, said = made.cell.arm, made.said
    header = ["image", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", *arm.joint_names]
    lines = [",".join(header)]
    rows = zip(made.names, said.translation, quaternions(said.rotation), made.joints, strict=True)
    for name, shift, q, joints in rows:
        numbers = ",".join(f"{value:.9g}" for value in (*shift, *q, *joints))
        lines.append(f"{FRAME.format(name.replace(' ', '_'))},{numbers}")
    return "\n".join(lines) + "\n"
