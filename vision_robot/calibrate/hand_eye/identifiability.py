"""What was not known in the end: a standard deviation that is no knowledge is refused, by name."""

import numpy as np

from vision_robot.calibrate.hand_eye.covariance import HandEyeCovariance
from vision_robot.calibrate.hand_eye.setup import Setup
from vision_robot.calibrate.hand_eye.words import degrees, direction, millimetres
from vision_robot.errors import DegeneratePoses
from vision_robot.geometry import SE3

__all__ = ["check_sigma"]

VAGUE = 0.05
"""A standard deviation of more than this part of the board's distance is no knowledge of a place."""

VAGUE_TURN = np.radians(3)


def check_sigma(known: HandEyeCovariance, setup: Setup, cam_from_board: SE3) -> None:
    """Raise DegeneratePoses where the camera's place is known no better than to that part."""
    reach = float(np.median(np.linalg.norm(cam_from_board.translation, axis=1)))
    values, vectors = np.linalg.eigh(known.mount_from_cam[3:, 3:])
    sigma = float(np.sqrt(values[-1]))
    mend = "turn the wrist by 30-60 degrees about more axes, and add views"
    if sigma > VAGUE * reach:
        along = direction(vectors[:, -1], setup.mount)
        raise DegeneratePoses(
            (f"the camera's position along {along}",),
            f"one standard deviation would be {millimetres(sigma)}, the board is {millimetres(reach)} away",
            mend,
        )
    if known.turn > VAGUE_TURN:
        why = f"one standard deviation would be {degrees(known.turn)}"
        raise DegeneratePoses(("how the camera is turned",), why, mend)
