"""Arms of several kinds, made from published dimensions, with awkward bases and tools."""

import numpy as np

from vision_robot.geometry import SE3, SerialChain

__all__ = [
    "PANDA",
    "PUMA_560",
    "UR5E",
    "column_elbow",
    "modified_dh",
    "rail_elbow",
    "standard_dh",
    "waist_elbow",
]


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


def _along(axes: list[list[float]], points: list[list[float]], slides: list[bool], tool: SE3) -> SerialChain:
    """A chain whose joint frames are parallel to the base at zero, turned by an arbitrary placement."""
    placed = SE3.from_rotvec(np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.2, 0.3]))
    steps = np.diff(np.array([[0.0, 0, 0], *points]), axis=0)
    links = SE3(np.tile(np.eye(3), (len(steps), 1, 1)), steps)
    first = placed @ links[0]
    n = len(axes)
    turning = np.array([[-170.0, 170.0]] * n)
    limits = np.radians(turning)
    limits[np.array(slides)] = [-0.4, 0.4]
    return SerialChain(
        joint_names=tuple(f"q{i + 1}" for i in range(n)),
        slides=np.array(slides),
        axes=np.array(axes, dtype=float),
        link_from_joint=SE3(
            np.concatenate([first.rotation[None], links.rotation[1:]]),
            np.concatenate([first.translation[None], links.translation[1:]]),
        ),
        last_from_wrist=SE3.identity(),
        limits=limits,
        wrist_from_tool=tool,
    )


TOOL = SE3.from_rotvec(np.array([0.2, 1.0, -0.4]), np.array([0.03, -0.02, 0.12]))
X, Y, Z = [1.0, 0, 0], [0.0, 1, 0], [0.0, 0, 1]


def column_elbow() -> SerialChain:
    """Column, waist, shoulder, elbow, roll, with offsets and a crooked tool."""
    points = [[0.0, 0, 0.2], [0.02, 0.01, 0.2], [0.05, 0.04, 0.25], [0.35, 0.02, 0.25], [0.55, 0.03, 0.24]]
    return _along([Z, Z, Y, [0, -1, 0], X], points, [True] + [False] * 4, TOOL)


def rail_elbow() -> SerialChain:
    """Rail, shoulder, elbow, wrist pitch, roll."""
    points = [[0.0, 0, 0.2], [0.02, 0.01, 0.2], [0.3, 0.04, 0.25], [0.55, 0.02, 0.25], [0.60, 0.03, 0.24]]
    return _along([Y, Y, [0, -1, 0], Y, X], points, [True] + [False] * 4, TOOL)


def waist_elbow() -> SerialChain:
    """Waist, shoulder, elbow, wrist pitch, roll."""
    points = [[0.0, 0, 0.1], [0.02, 0.01, 0.2], [0.3, 0.04, 0.25], [0.55, 0.02, 0.25], [0.60, 0.03, 0.24]]
    return _along([Z, Y, [0, -1, 0], Y, X], points, [False] * 5, TOOL)
