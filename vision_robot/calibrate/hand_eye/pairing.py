"""Whether each picture belongs to the pose beside it: lists out of step, shuffled, or two swapped.

Fits do not need the pairing to be right to find it: the closed form is asked under every lag, and for a
shuffled list three pictures are tried with every three poses whose motions turn and shift as much.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.closed_forms import shah
from vision_robot.calibrate.hand_eye.conventions import BETTER, CONTRADICTION
from vision_robot.calibrate.hand_eye.start import Fit, closed_fit, disagreement
from vision_robot.errors import ContradictingPoses
from vision_robot.geometry import SE3
from vision_robot.types import Array, Float, Int

__all__ = ["between", "check_pairing", "lagged", "matched_order", "other_pose"]

FEWEST_TO_TELL = 5
MOST_LAG = 5
SAME_ANGLE, SAME_SHIFT_M = np.radians(0.6), 4e-3
"""How nearly a motion of the arm and one of the pictures must agree to be tried as the same."""

MOST_TRIED = 400
ENOUGH = 0.6
"""Part of the pictures that must find a pose for an order to be believed."""


@dataclass(frozen=True)
class Lag:
    """Steps by which the poses run late, whole or in part, and how the views agree then."""

    steps: float
    typical: float


def check_pairing(mount_from_far: SE3, cam_from_board: SE3, fit: Fit) -> None:
    """Raise ContradictingPoses, naming the order found, where another pairing explains far more."""
    n = len(cam_from_board)
    agree = int(fit.agree.sum()) if fit.typical < CONTRADICTION else 0
    if n < FEWEST_TO_TELL or (agree >= ENOUGH * n and fit.typical < CONTRADICTION):
        return
    lag = lagged(mount_from_far, cam_from_board)
    if lag.typical * BETTER < fit.typical and lag.typical < CONTRADICTION:
        steps = f"{abs(lag.steps):g} step{'s' if abs(lag.steps) != 1 else ''}"
        late = "after" if lag.steps > 0 else "before"
        first = 1 if lag.steps > 0 else 1 + int(np.ceil(-lag.steps))
        raise ContradictingPoses(
            f"the lists are out of step by {steps} (the pictures fit the poses {late} them: picture {first} "
            f"belongs to pose {first + lag.steps:g})",
            "pair each picture with the pose at which it was taken",
            [i + int(lag.steps) if 0 <= i + lag.steps < n else -1 for i in range(n)],
        )
    order = matched_order(mount_from_far, cam_from_board)
    moved = [
        f"picture {i + 1} fits pose {j + 1}"
        for i, j in enumerate(order if order is not None else ())
        if j >= 0 and i != j
    ]
    if order is not None and moved:
        more = f" and {len(moved) - 6} more" if len(moved) > 6 else ""
        raise ContradictingPoses(
            f"they are shuffled: {', '.join(moved[:6])}{more}",
            "pair each picture with the pose at which it was taken",
            order.tolist(),
        )


def lagged(mount_from_far: SE3, cam_from_board: SE3) -> Lag:
    """The lag, in whole steps or in tenths of one, under which the views agree best."""
    n = len(cam_from_board)
    most = min(MOST_LAG, n - FEWEST_TO_TELL)
    whole = [
        (closed_fit(*_overlap(mount_from_far, cam_from_board, k)).typical, float(k))
        for k in range(-most, most + 1)
    ]
    typical, steps = min(whole)
    parts = [step for step in np.arange(-0.9, 0.95, 0.1) if abs(step) > 0.05]
    for part in parts:
        moved = between(mount_from_far, part)
        some = slice(0, n - 1) if part > 0 else slice(1, n)
        found = closed_fit(moved, cam_from_board[some]).typical
        if found < typical:
            typical, steps = found, float(round(part, 1))
    return Lag(steps, typical)


def _overlap(mount_from_far: SE3, cam_from_board: SE3, lag: int) -> tuple[SE3, SE3]:
    """Poses from `lag` on, beside the pictures from the first on."""
    n = len(cam_from_board)
    return mount_from_far[max(lag, 0) : n + min(lag, 0)], cam_from_board[max(-lag, 0) : n - max(lag, 0)]


def between(poses: SE3, part: float) -> SE3:
    """Poses `part` of the way on to the next one (or back to the last, where negative); one fewer."""
    n = len(poses)
    start, end = (poses[: n - 1], poses[1:]) if part > 0 else (poses[1:], poses[: n - 1])
    motion = start.inverse() @ end
    return start @ SE3.from_rotvec(abs(part) * motion.rotvec(), abs(part) * motion.translation)


def other_pose(
    mount_from_cam: SE3, far_from_board: SE3, mount_from_far: SE3, seen: SE3
) -> tuple[int, Float[Array, "n"], Float[Array, "n"]]:
    """The pose that fits one picture's `seen` best, with all turns [rad] and shifts [m]."""
    many = SE3(
        np.broadcast_to(seen.rotation, (len(mount_from_far), 3, 3)),
        np.broadcast_to(seen.translation, (len(mount_from_far), 3)),
    )
    turn, shift = disagreement(mount_from_cam, far_from_board, mount_from_far, many)
    reach = float(np.linalg.norm(seen.translation))
    return int(np.argmin(np.hypot(turn, shift / reach))), turn, shift


def matched_order(mount_from_far: SE3, cam_from_board: SE3) -> Int[Array, "n"] | None:
    """The pose each picture fits, -1 for none; None where no order explains enough of them."""
    n = len(cam_from_board)
    angle_a, shift_a = _invariants(mount_from_far)
    angle_b, shift_b = _invariants(cam_from_board)
    best: Int[Array, n] | None = None
    tried = 0
    for i, j, k in _broad_triples(angle_b):
        same = {
            pair: (np.abs(angle_a - angle_b[pair]) < SAME_ANGLE)
            & (np.abs(shift_a - shift_b[pair]) < SAME_SHIFT_M)
            for pair in ((i, j), (i, k), (j, k))
        }
        for p, q in np.argwhere(same[i, j]):
            for r in np.flatnonzero(same[i, k][p] & same[j, k][q]):
                if len({p, q, r}) < 3 or tried >= MOST_TRIED:
                    continue
                tried += 1
                order = _grown(mount_from_far, cam_from_board, [i, j, k], [int(p), int(q), int(r)])
                if best is None or (order >= 0).sum() > (best >= 0).sum():
                    best = order
        if best is not None and (best >= 0).sum() >= max(ENOUGH * n, FEWEST_TO_TELL):
            return best
    return None


def _invariants(poses: SE3) -> tuple[Float[Array, "n n"], Float[Array, "n n"]]:
    """Angle of the motion between every two poses, and the length of its shift along the axis."""
    relative = SE3(poses.rotation[:, None], poses.translation[:, None]) @ poses.inverse()
    turn = relative.rotvec()
    angle = np.linalg.norm(turn, axis=-1)
    axis = turn / np.maximum(angle, 1e-6)[..., None]
    return angle, np.abs((axis * relative.translation).sum(axis=-1))


def _broad_triples(angle: Float[Array, "n n"], count: int = 6) -> list[tuple[int, int, int]]:
    """A few triples of views that turn much from each other."""
    rng = np.random.default_rng(0)
    n = len(angle)
    some = np.array([rng.choice(n, 3, replace=False) for _ in range(300)])
    i, j, k = some.T
    least = np.minimum(np.minimum(angle[i, j], angle[i, k]), angle[j, k])
    least = np.where(least > np.radians(165), 0, least)
    return [(int(a), int(b), int(c)) for a, b, c in some[np.argsort(-least)[:count]]]


def _grown(
    mount_from_far: SE3, cam_from_board: SE3, pictures: list[int], poses: list[int]
) -> Int[Array, "n"]:
    """From three pairs to all that fit along with them."""
    from scipy.optimize import linear_sum_assignment

    n = len(cam_from_board)
    order = np.full(n, -1)
    order[pictures] = poses
    reach = float(np.median(np.linalg.norm(cam_from_board.translation, axis=1)))
    for tolerance in (20 * CONTRADICTION, 4 * CONTRADICTION, 2 * CONTRADICTION):
        held = np.flatnonzero(order >= 0)
        if len(held) < 3:
            break
        X, Z = shah.solve(mount_from_far[order[held]], cam_from_board[held])
        said = X.inverse() @ mount_from_far @ Z
        turn = SE3(
            said.rotation[None] @ np.swapaxes(cam_from_board.rotation, 1, 2)[:, None], np.zeros(3)
        ).rotvec()
        shift = said.translation[None] - cam_from_board.translation[:, None]
        size = np.hypot(np.linalg.norm(turn, axis=-1), np.linalg.norm(shift, axis=-1) / reach)
        rows, columns = linear_sum_assignment(np.minimum(size, tolerance))
        order = np.full(n, -1)
        good = size[rows, columns] < tolerance
        order[rows[good]] = columns[good]
    return order
