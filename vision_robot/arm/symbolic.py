"""Kinematics, residual and one damped Gauss-Newton step of an arm as CasADi functions.

All are SX functions, without branches or loops, so that they run in CasADi's interpreter, as numpy
over many targets (`vision_robot.arm.vectorised`) and as C.

A pose is twelve numbers: the upper three rows of its matrix one after the other,
``pose.as_matrix()[:3].ravel()`` = (r00, r01, r02, x, r10, r11, r12, y, r20, r21, r22, z).
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from vision_robot.arm.task import Task
from vision_robot.geometry import SerialChain
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from casadi import SX, Function

__all__ = ["base_from_tool", "jacobian", "length_scale", "lm_step", "residual", "rows_of_pose"]

DAMPING = 0.01
"""What |r|, in units of the length scale, damps a step by: as little as keeps most searches on their way."""

LEAST_DAMPING = 1e-13
"""Keeps the equations solvable where the arm is singular; in units of the length scale squared."""


def base_from_tool(chain: SerialChain) -> "Function":
    """``base_from_tool(q) -> pose``: (n,) to (12,)."""
    import casadi as ca

    q = ca.SX.sym("q", len(chain))
    _, _, rotation, position = _kinematics(chain, q)
    return ca.Function("base_from_tool", [q], [rows_of_pose(rotation, position)], ["q"], ["pose"])


def jacobian(chain: SerialChain) -> "Function":
    """``jacobian(q) -> J``: (n,) to (6, n), the geometric Jacobian of the tool as `SerialChain.jacobian`."""
    import casadi as ca

    q = ca.SX.sym("q", len(chain))
    J = ca.densify(ca.vertcat(*_geometric_jacobian(chain, *_kinematics(chain, q))))
    return ca.Function("jacobian", [q], [J], ["q"], ["J"])


def residual(chain: SerialChain, task: Task = Task.POSE) -> "Function":
    """``residual(q, goal) -> r, J, error``.

    r [m], with angles times the length scale, and J with ``r(q + dq) = r + J dq`` to first order; error
    (2,) is the distance from the goal [m] and 2 sin(angle / 2), which is the angle [rad] where that is small.
    """
    import casadi as ca

    q, goal = ca.SX.sym("q", len(chain)), ca.SX.sym("goal", 12)
    r, J, error = _residual(chain, task, q, goal)
    return ca.Function("residual", [q, goal], [r, ca.densify(J), error], ["q", "goal"], ["r", "J", "error"])


def lm_step(chain: SerialChain, task: Task = Task.POSE, *, damping: float = DAMPING) -> "Function":
    """``lm_step(q, goal) -> next_q, error``: one step towards the goal, never past a limit.

    `error` (2,), distance [m] and angle [rad], is that of q, not of next_q. The step minimises
    |r + J dq|^2 + lambda |dq|^2, lambda being `damping` times |r|, over joints that do not press against
    their limit, and is then cut to the limits. No step looks back: near the goal they converge
    quadratically, and where the arm is singular they still halve the way (Fan & Yuan 2005, Computing 74).
    """
    import casadi as ca

    q, goal = ca.SX.sym("q", len(chain)), ca.SX.sym("goal", 12)
    r, J, error = _residual(chain, task, q, goal)
    scale = length_scale(chain)
    gradient, H = ca.mtimes(J.T, r), ca.mtimes(J.T, J)
    weakening = damping * ca.sqrt(ca.dot(r, r)) / scale + LEAST_DAMPING
    weight = [1.0 if slides else scale**2 for slides in chain.slides]
    free = []
    for i, (low, high) in enumerate(chain.limits):
        pressed = ca.logic_or(
            ca.logic_and(q[i] <= low, gradient[i] > 0), ca.logic_and(q[i] >= high, gradient[i] < 0)
        )
        free.append(1 - pressed)
    n = len(chain)
    rows = [[H[i, j] * free[i] * free[j] for j in range(n)] for i in range(n)]
    for i in range(n):
        rows[i][i] = rows[i][i] + weight[i] * (weakening + (1 - free[i]))
    step = _solve_positive(rows, [-gradient[i] * free[i] for i in range(n)])
    inside = [ca.fmin(ca.fmax(q[i] + step[i], low), high) for i, (low, high) in enumerate(chain.limits)]
    return ca.Function("lm_step", [q, goal], [ca.vertcat(*inside), error], ["q", "goal"], ["next_q", "error"])


def length_scale(chain: SerialChain) -> float:
    """Length [m] by which angles are made comparable with distances: about the arm's link length."""
    lengths = np.linalg.norm(chain.link_from_joint.translation, axis=1)[1:]
    hand = float(np.linalg.norm((chain.last_from_wrist @ chain.wrist_from_tool).translation))
    return max(float(np.max(lengths, initial=0.0)), hand, 1e-3)


def rows_of_pose(rotation: Any, position: Any) -> Any:
    """The twelve numbers of a pose from its symbols."""
    import casadi as ca

    return ca.vertcat(
        *(ca.vertcat(rotation[i, 0], rotation[i, 1], rotation[i, 2], position[i]) for i in range(3))
    )


def _residual(chain: SerialChain, task: Task, q: "SX", goal: "SX") -> tuple["SX", "SX", "SX"]:
    import casadi as ca

    frames = _kinematics(chain, q)
    _, _, R, p = frames
    Jv, Jw = _geometric_jacobian(chain, *frames)
    goal_R = ca.vertcat(*(goal[4 * i : 4 * i + 3].T for i in range(3)))
    missing = p - ca.vertcat(goal[3], goal[7], goal[11])
    far = ca.sqrt(ca.dot(missing, missing))
    if task is Task.POSITION:
        return missing, Jv, ca.vertcat(far, 0)
    scale = length_scale(chain)
    if task is Task.POSE:
        # Half the sum of cross products is sin(angle) times the axis from R to the goal; its product with
        # Jw is the exact gradient of the chordal distance (Luh, Walker & Paul 1980).
        turn = sum((ca.cross(R[:, i], goal_R[:, i]) for i in range(3)), ca.SX.zeros(3)) / 2
        # 2 sin(angle / 2) from the sine, which keeps its digits near zero; from the trace past 90 degrees.
        trace = sum((ca.dot(R[:, i], goal_R[:, i]) for i in range(3)), ca.SX(0))
        cosine = (trace - 1) / 2
        from_sine = ca.sqrt(ca.dot(turn, turn) * 2 / (1 + ca.fmax(cosine, 0)))
        chord = ca.if_else(cosine > 0, from_sine, ca.sqrt(ca.fmax(3 - trace, 0)))
        return (
            ca.vertcat(missing, -scale * turn),
            ca.vertcat(Jv, scale * Jw),
            ca.vertcat(far, chord),
        )
    if task is Task.AXIS:
        off, rows = R[:, 2] - goal_R[:, 2], -_cross_matrix(R[:, 2])
    else:
        off, rows = (R[2, :] - goal_R[2, :]).T, ca.mtimes(R.T, ca.DM([[0, -1, 0], [1, 0, 0], [0, 0, 0]]))
    return (
        ca.vertcat(missing, scale * off),
        ca.vertcat(Jv, scale * ca.mtimes(rows, Jw)),
        ca.vertcat(far, ca.sqrt(ca.dot(off, off))),
    )


def _cross_matrix(a: "SX") -> "SX":
    import casadi as ca

    return ca.vertcat(ca.horzcat(0, -a[2], a[1]), ca.horzcat(a[2], 0, -a[0]), ca.horzcat(-a[1], a[0], 0))


def _kinematics(chain: SerialChain, q: "SX") -> tuple[list["SX"], list["SX"], "SX", "SX"]:
    """Axis and a point on it for each joint, then rotation and position of the tool, all in the base."""
    import casadi as ca

    axes, points = [], []
    R, p = ca.SX.eye(3), ca.SX.zeros(3)
    back = np.eye(3)
    for i in range(len(chain)):
        # Each joint's frame is turned so that its axis is z: a turn then mixes two columns only.
        to_z = _frame_along(chain.axes[i])
        fixed = chain.link_from_joint[i]
        p = p + ca.mtimes(R, _constant(back @ fixed.translation))
        R = ca.mtimes(R, _constant(back @ fixed.rotation @ to_z))
        axes.append(R[:, 2])
        points.append(p)
        if chain.slides[i]:
            p = p + R[:, 2] * q[i]
        else:
            c, s = ca.cos(q[i]), ca.sin(q[i])
            R = ca.horzcat(R[:, 0] * c + R[:, 1] * s, R[:, 1] * c - R[:, 0] * s, R[:, 2])
        back = to_z.T
    last = chain.last_from_wrist @ chain.wrist_from_tool
    p = p + ca.mtimes(R, _constant(back @ last.translation))
    R = ca.mtimes(R, _constant(back @ last.rotation))
    return axes, points, R, p


def _frame_along(axis: Float[Array, "3"]) -> Float[Array, "3 3"]:
    """A rotation whose z column is `axis`; of zeros and ones where the axis is one of the frame's."""
    k = int(np.argmax(np.abs(axis)))
    first = np.zeros(3)
    first[(k + 1) % 3] = 1
    second = np.cross(axis, first)
    second /= np.linalg.norm(second)
    return np.stack([np.cross(second, axis), second, axis], axis=1)


def _constant(values: Float[Array, "*shape"]) -> "SX":
    """Numbers as symbols, rounding dust swept to the zero or one that was meant: zeros cost no operation."""
    import casadi as ca

    near = np.round(values)
    return ca.sparsify(ca.SX(ca.DM(np.where(np.abs(values - near) < 1e-15, near, values))))


def _geometric_jacobian(
    chain: SerialChain, axes: list["SX"], points: list["SX"], _: "SX", tip: "SX"
) -> tuple["SX", "SX"]:
    import casadi as ca

    moves, turns = [], []
    for slides, axis, point in zip(chain.slides, axes, points, strict=True):
        moves.append(axis if slides else ca.cross(axis, tip - point))
        turns.append(ca.SX(3, 1) if slides else axis)
    return ca.horzcat(*moves), ca.horzcat(*turns)


def _solve_positive(rows: list[list[Any]], right: list[Any]) -> list[Any]:
    """Solution of a symmetric positive definite system by its factors L D L^T, written out."""
    n = len(right)
    L: list[list[Any]] = [[0.0] * n for _ in range(n)]
    LD: list[list[Any]] = [[0.0] * n for _ in range(n)]
    inverse_d: list[Any] = [0.0] * n
    for j in range(n):
        inverse_d[j] = 1 / (rows[j][j] - sum(LD[j][k] * L[j][k] for k in range(j)))
        for i in range(j + 1, n):
            LD[i][j] = rows[i][j] - sum(LD[i][k] * L[j][k] for k in range(j))
            L[i][j] = LD[i][j] * inverse_d[j]
    forward: list[Any] = []
    for i in range(n):
        forward.append(right[i] - sum(L[i][k] * forward[k] for k in range(i)))
    solution: list[Any] = [0.0] * n
    for i in reversed(range(n)):
        solution[i] = forward[i] * inverse_d[i] - sum(L[k][i] * solution[k] for k in range(i + 1, n))
    return solution
