"""Arms of several kinds by the dimensions their makers publish."""

import numpy as np

from vision_robot.geometry import SE3, SerialChain

__all__ = ["PANDA", "PUMA_560", "UR5E", "modified_dh", "standard_dh"]


def standard_dh(
    rows: list[tuple[float, float, float]], limits_deg: list[tuple[float, float]], tool: SE3 | None = None
) -> SerialChain:
    """Turning joints by (a, alpha, d), Denavit and Hartenberg's first form: Rz(q) Tz(d) Tx(a) Rx(alpha)."""
    after = [SE3.from_rotvec(np.array([alpha, 0.0, 0.0]), np.array([a, 0.0, d])) for a, alpha, d in rows]
    links = [SE3.identity(), *after[:-1]]
    return _turning(links, after[-1], limits_deg, tool)


def modified_dh(
    rows: list[tuple[float, float, float]], limits_deg: list[tuple[float, float]], tool: SE3 | None = None
) -> SerialChain:
    """Turning joints by (a, alpha, d), Craig's form: Rx(alpha) Tx(a) Rz(q) Tz(d)."""
    links = []
    for a, alpha, d in rows:
        lifted = SE3(np.eye(3), np.array([0.0, 0, d]))
        links.append(SE3.from_rotvec(np.array([alpha, 0.0, 0.0]), np.array([a, 0.0, 0.0])) @ lifted)
    return _turning(links, SE3.identity(), limits_deg, tool)


def _turning(
    links: list[SE3], last: SE3, limits_deg: list[tuple[float, float]], tool: SE3 | None
) -> SerialChain:
    n = len(links)
    return SerialChain(
        joint_names=tuple(f"q{i + 1}" for i in range(n)),
        slides=np.zeros(n, dtype=bool),
        axes=np.tile([0.0, 0, 1], (n, 1)),
        link_from_joint=SE3(
            np.array([link.rotation for link in links]), np.array([link.translation for link in links])
        ),
        last_from_wrist=last,
        limits=np.radians(limits_deg),
        wrist_from_tool=tool or SE3.identity(),
    )


RIGHT = np.pi / 2

UR5E = standard_dh(
    [
        (0, RIGHT, 0.1625),
        (-0.425, 0, 0),
        (-0.3922, 0, 0),
        (0, RIGHT, 0.1333),
        (0, -RIGHT, 0.0997),
        (0, 0, 0.0996),
    ],
    [(-360, 360), (-360, 360), (-180, 180), (-360, 360), (-360, 360), (-360, 360)],
)
"""Universal Robots' published table for the UR5e, and its joint ranges."""

PUMA_560 = standard_dh(
    [
        (0, RIGHT, 0),
        (0.4318, 0, 0),
        (0.0203, -RIGHT, 0.15005),
        (0, RIGHT, 0.4318),
        (0, -RIGHT, 0),
        (0, 0, 0),
    ],
    [(-160, 160), (-110, 110), (-135, 135), (-266, 266), (-100, 100), (-266, 266)],
)
"""Puma 560 (Corke & Armstrong-Helouvry 1994)."""

PANDA = modified_dh(
    [
        (0, 0, 0.333),
        (0, -RIGHT, 0),
        (0, RIGHT, 0.316),
        (0.0825, RIGHT, 0),
        (-0.0825, -RIGHT, 0.384),
        (0, RIGHT, 0),
        (0.088, RIGHT, 0),
    ],
    [
        (-166.0, 166.0),
        (-101.0, 101.0),
        (-166.0, 166.0),
        (-176.0, -4.0),
        (-166.0, 166.0),
        (-1.0, 215.0),
        (-166.0, 166.0),
    ],
    SE3(np.eye(3), np.array([0, 0, 0.107])),
)
"""Franka's published table for its seven-joint Panda."""
