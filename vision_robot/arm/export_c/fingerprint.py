"""A number that tells arms apart: computer and microcontroller compare it before anything moves."""

import zlib

import numpy as np

from vision_robot.geometry import SE3, SerialChain

__all__ = ["fingerprint"]


def fingerprint(chain: SerialChain) -> int:
    """CRC-32 of joint names, geometry, limits and tool, to seven decimals (0.1 um)."""
    poses = [chain.link_from_joint, chain.last_from_wrist, chain.wrist_from_tool]
    numbers = [chain.slides, chain.axes, chain.limits, *(_numbers(pose) for pose in poses)]
    words = [*chain.joint_names]
    for array in numbers:
        # Adding zero turns -0 into 0.
        words += [f"{value:.7f}" for value in (np.round(np.asarray(array, dtype=float), 7) + 0.0).ravel()]
    return zlib.crc32(" ".join(words).encode())


def _numbers(pose: SE3) -> np.ndarray:
    return pose.as_matrix()[..., :3, :]
