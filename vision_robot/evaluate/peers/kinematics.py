"""Other people's inverse kinematics: goals in, joint values out, rows of NaN where a solver gave up.

Each is used as its makers recommend for a success near 100 %, restarts included; all know the limits.
"""

from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, SerialChain
from vision_robot.types import Array, Float

__all__ = ["IK_PEERS", "IkPeer", "ik_peer"]

IkPeer = Callable[[SE3], Float[Array, "goals n"]]

CLOSE_M = 1e-6
RESTARTS = 100
TRAC_IK_S = 0.005
"""For a goal, as its authors have it."""


def ik_peer(name: str, chain: SerialChain) -> IkPeer:
    """A peer's solver of an arm, built. Raises BadParameter for one not known or not installed."""
    if name not in IK_PEERS:
        raise BadParameter("peer", name, f"one of {', '.join(IK_PEERS)} (others are not installed)")
    return IK_PEERS[name](chain)


def _ipopt(chain: SerialChain) -> IkPeer:
    """Interior points on the sum of squares, exact Hessian, from the middle and then from anywhere inside."""
    import casadi as ca

    from vision_robot.arm.symbolic import residual

    q, goal = ca.SX.sym("q", len(chain)), ca.SX.sym("goal", 12)
    told = residual(chain)
    r, _, error = told(q, goal)
    quiet = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-14, "max_iter": 60}}
    solver = ca.nlpsol("ipopt_ik", "ipopt", {"x": q, "p": goal, "f": 1e4 * ca.dot(r, r)}, quiet)
    off = ca.Function("off", [q, goal], [error])
    low, high = chain.limits.T

    def one(wanted: Array, rng: np.random.Generator) -> Array | None:
        start = (low + high) / 2
        for _ in range(RESTARTS):
            found = np.ravel(np.array(solver(x0=start, p=wanted, lbx=low, ubx=high)["x"]))
            # It may end a rounding error past a limit.
            found = np.clip(found, low, high)
            if np.ravel(np.array(off(found, wanted))).max() < CLOSE_M:
                return found
            start = rng.uniform(low, high)
        return None

    def solve(goals: SE3) -> Array:
        rng = np.random.default_rng(0)
        return _rows((one(pose[:3].ravel(), rng) for pose in goals.as_matrix()), len(chain))

    return solve


def _toolbox(method: str) -> Callable[[SerialChain], IkPeer]:
    def build(chain: SerialChain) -> IkPeer:
        rtb, spatialmath = import_module("roboticstoolbox"), import_module("spatialmath")

        def fixed(pose: Array) -> Any:
            return rtb.ET.SE3(spatialmath.SE3(pose, check=False))

        parts = []
        for link, axis, slides in zip(
            chain.link_from_joint.as_matrix(), chain.axes, chain.slides, strict=True
        ):
            index = int(np.argmax(np.abs(axis)))
            if abs(axis[index]) < 1 - 1e-12:
                raise BadParameter("joint axis", axis.tolist(), "x, y or z of its own frame for this peer")
            make = getattr(rtb.ET, ("t" if slides else "R") + "xyz"[index])
            parts += [fixed(link), make(flip=bool(axis[index] < 0))]
        ets = rtb.ETS([*parts, fixed((chain.last_from_wrist @ chain.wrist_from_tool).as_matrix())])
        ets.qlim = chain.limits.T
        options: dict[str, Any] = {"ilimit": 30, "slimit": RESTARTS, "tol": 1e-12, "joint_limits": True}
        if method == "LM":
            options |= {"k": 0.1, "method": "chan"}
        search = getattr(ets, f"ik_{method}")

        def one(goal: Array) -> Array | None:
            found = search(goal, **options)
            return np.ravel(found.q) if found.success else None

        return lambda goals: _rows((one(goal) for goal in goals.as_matrix()), len(chain))

    return build


def _trac_ik(chain: SerialChain) -> IkPeer:
    from scipy.spatial.transform import Rotation

    pytracik = import_module("pytracik")
    last = f"l{len(chain) + 1}"
    solver = pytracik.TRAC_IK("l0", last, urdf_text(chain), TRAC_IK_S, CLOSE_M, pytracik.SolveType.Speed)
    middle = chain.limits.mean(axis=1)

    def one(goal: Array) -> Array | None:
        found = np.asarray(
            pytracik.ik(solver, middle, *goal[:3, 3], *Rotation.from_matrix(goal[:3, :3]).as_quat())
        )
        return found[1:] if found[0] >= 0 else None

    return lambda goals: _rows((one(goal) for goal in goals.as_matrix()), len(chain))


def urdf_text(chain: SerialChain) -> str:
    """The chain from link l0 to the tool as a URDF, which most solvers read and nothing else."""
    from scipy.spatial.transform import Rotation

    def words(values: Array) -> str:
        return " ".join(f"{value:.17g}" for value in values)

    def origin(pose: Array) -> str:
        angles = Rotation.from_matrix(pose[:3, :3]).as_euler("xyz")
        return f'<origin xyz="{words(pose[:3, 3])}" rpy="{words(angles)}"/>'

    n = len(chain)
    lines = ['<robot name="arm">', *(f'<link name="l{k}"/>' for k in range(n + 2))]
    for k, link in enumerate(chain.link_from_joint.as_matrix()):
        kind = "prismatic" if chain.slides[k] else "revolute"
        low, high = chain.limits[k]
        lines.append(
            f'<joint name="j{k}" type="{kind}"><parent link="l{k}"/><child link="l{k + 1}"/>{origin(link)}'
            f'<axis xyz="{words(chain.axes[k])}"/>'
            f'<limit lower="{low:.17g}" upper="{high:.17g}" effort="1" velocity="1"/></joint>'
        )
    hand = origin((chain.last_from_wrist @ chain.wrist_from_tool).as_matrix())
    lines.append(
        f'<joint name="tool" type="fixed"><parent link="l{n}"/><child link="l{n + 1}"/>{hand}</joint></robot>'
    )
    return "\n".join(lines)


def _rows(found: Iterator[Array | None], n: int) -> Array:
    return np.array([np.full(n, np.nan) if row is None else row for row in found]).reshape(-1, n)


KNOWN: dict[str, tuple[str, Callable[[SerialChain], IkPeer]]] = {
    "casadi-ipopt": ("casadi", _ipopt),
    "roboticstoolbox-lm": ("roboticstoolbox", _toolbox("LM")),
    "roboticstoolbox-gn": ("roboticstoolbox", _toolbox("GN")),
    "trac-ik": ("pytracik", _trac_ik),
}
"""Name -> (the package it needs, what builds it for an arm)."""

IK_PEERS: dict[str, Callable[[SerialChain], IkPeer]] = {
    name: build for name, (package, build) in KNOWN.items() if find_spec(package)
}
"""Those whose package is installed."""
