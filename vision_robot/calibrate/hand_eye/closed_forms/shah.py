"""M. Shah, "Solving the robot-world/hand-eye calibration problem using the Kronecker product", 2013."""

import numpy as np

from vision_robot.calibrate.hand_eye.closed_forms.translation import nearest_rotation
from vision_robot.geometry import SE3

__all__ = ["solve"]


def solve(mount_from_far: SE3, cam_from_board: SE3) -> tuple[SE3, SE3]:
    """Both unknowns of ``A Z = X B`` at once; rotation matrices have no trouble with half turns."""
    A, B = mount_from_far, cam_from_board
    # sum (R_B kron R_A) vec(R_Z) = n vec(R_X), columns stacked: the largest singular pair.
    total = np.einsum("nij,nkl->ikjl", B.rotation, A.rotation).reshape(9, 9)
    U, _, Vt = np.linalg.svd(total)
    x, z = U[:, 0].reshape(3, 3).T, Vt[0].reshape(3, 3).T
    x, z = (nearest_rotation(m * np.sign(np.linalg.det(m))) for m in (x, z))
    # R_A t_Z - t_X = R_X t_B - t_A.
    n = len(A)
    rows = np.concatenate([A.rotation, np.broadcast_to(-np.eye(3), (n, 3, 3))], axis=2).reshape(-1, 6)
    right = (B.translation @ x.T - A.translation).reshape(-1)
    t = np.linalg.lstsq(rows, right, rcond=None)[0]
    return SE3(x, t[3:]), SE3(z, t[:3])
