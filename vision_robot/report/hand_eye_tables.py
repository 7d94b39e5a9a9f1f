"""Tables of a hand-eye page."""

import numpy as np

from vision_robot.calibrate.hand_eye import HandEyeResult
from vision_robot.calibrate.hand_eye.judgement import HandEyeJudgement
from vision_robot.calibrate.hand_eye.judgement.error_budget import HandEyeBudget
from vision_robot.calibrate.hand_eye.judgement.next_pose import NextPoses
from vision_robot.geometry import SE3
from vision_robot.geometry.hand_eye import HandEye
from vision_robot.report.page import Table
from vision_robot.report.quantity import compact, listed, signed, with_sigma

__all__ = [
    "budget_table",
    "closed_form_table",
    "link_table",
    "next_table",
    "rejected_table",
    "transform_table",
    "views_table",
]

MOST_ROWS = 60


def transform_table(result: HandEyeResult, truth: HandEye | None) -> Table:
    """Both transforms with their sigmas and intervals."""
    known, found = result.covariance, result.hand_eye
    columns = ["", "", "value", "σ", "± 95 %", "unit"]
    numeric = {2, 3, 4}
    if truth is not None:
        columns += ["truth", "error / σ"]
        numeric |= {6, 7}
    rows = []
    pairs = ((found.mount_name, found.mount_from_cam, 0), (found.far_name, found.far_from_board, 6))
    for name, pose, first in pairs:
        true = None if truth is None else (truth.mount_from_cam if first == 0 else truth.far_from_board)
        step = None if true is None else _step(pose, true)
        for k in range(6):
            shift = k < 3
            index = first + (3 + k if shift else k - 3)
            factor = 1e3 if shift else float(np.degrees(1))
            value = (pose.translation if shift else pose.rotvec())[k % 3] * factor
            sigma, half = factor * known.sigma[index], factor * known.half_width[index]
            shown, spread = with_sigma(float(value), float(sigma))
            row = [name if k == 0 else "", f"{'' if shift else 'turn '}{'xyz'[k % 3]}", shown, spread,
                   compact(float(half), 2), "mm" if shift else "°"]  # fmt: skip
            if true is not None and step is not None:
                at = (true.translation if shift else true.rotvec())[k % 3] * factor
                decimals = len(shown.partition(".")[2])
                row += [
                    signed(f"{at:.{decimals}f}"),
                    signed(f"{step[index - first] / known.sigma[index]:+.1f}"),
                ]
            rows.append(tuple(row))
    return Table(
        tuple(columns),
        tuple(rows),
        "The transforms found; turn is the rotation vector. σ is one standard deviation, 95 % the "
        "half-width of "
        "Student's interval, since the arm's noise was estimated from the same views.",
        frozenset(numeric),
    )


def _step(found: SE3, true: SE3) -> np.ndarray:
    turn = SE3(found.rotation @ true.rotation.T, np.zeros(3)).rotvec()
    return np.concatenate([turn, found.translation - true.translation])


def budget_table(budget: HandEyeBudget) -> Table:
    """What makes the error, of the camera's place and of one look."""
    rows = [("where the camera sits", name, compact(1e3 * value)) for name, value in budget.mount.items()]
    rows += [
        (f"one look at {compact(1e3 * budget.distance_m)} mm", name, compact(1e3 * value))
        for name, value in budget.look.items()
    ]
    caption = (
        "Root mean square error, all axes together, by cause. One look is the place in the base frame of a "
        "point seen "
        "once before the camera."
    )
    return Table(("error of", "cause", "mm"), tuple(rows), caption, frozenset({2}))


def closed_form_table(result: HandEyeResult, truth: HandEye | None) -> Table:
    """How far the closed forms are from what was found, and from the truth."""
    found = result.mount_from_cam
    columns = ["", "from ours [mm]", "from ours [°]"]
    poses = {"joint refinement": found, **{name: mount for name, (mount, _) in result.closed_forms.items()}}
    rows = []
    for name, mount in poses.items():
        row = [name, *_apart(mount, found)]
        if truth is not None:
            row += _apart(mount, truth.mount_from_cam)
        rows.append(tuple(row))
    if truth is not None:
        columns += ["from the truth [mm]", "from the truth [°]"]
    caption = "Closed forms from the same views, which know nothing of noise, beside the joint refinement."
    return Table(tuple(columns), tuple(rows), caption, frozenset(range(1, len(columns))))


def _apart(one: SE3, other: SE3) -> list[str]:
    turn = np.linalg.norm(SE3(one.rotation @ other.rotation.T, np.zeros(3)).rotvec())
    shift = np.linalg.norm(one.translation - other.translation)
    return [compact(1e3 * float(shift)), compact(float(np.degrees(turn)))]


def next_table(poses: NextPoses) -> Table:
    """Where to drive next."""
    rows = tuple(
        (str(i + 1), f"{words[:1].upper()}{words[1:]}.", compact(1e3 * alone), compact(1e3 * together))
        for i, (words, alone, together) in enumerate(
            zip(poses.words, poses.alone_m, poses.together_m, strict=True)
        )
    )
    caption = (
        f"Poses that lower the error of a point before the camera most, now {compact(1e3 * poses.sigma_m)} "
        "mm: with this "
        "pose alone, and with it and all before it."
    )
    return Table(("pose", "where to drive", "alone [mm]", "together [mm]"), rows, caption, frozenset({2, 3}))


def link_table(result: HandEyeResult) -> Table | None:
    """Corrections of the arm's links, where they were estimated."""
    geometry = result.geometry
    if geometry is None:
        return None
    rows = tuple(
        (
            name,
            *(compact(float(np.degrees(v))) for v in error[:3]),
            *(compact(1e3 * float(v)) for v in error[3:]),
        )
        for name, error in zip(geometry.chain.joint_names, geometry.link_errors, strict=True)
    )
    columns = ("joint", "turn x [°]", "turn y [°]", "turn z [°]", "x [mm]", "y [mm]", "z [mm]")
    caption = (
        "How each joint sits otherwise than in the model, in its own frame. Combinations that no pose can "
        "tell apart "
        "(a shift along a hinge's axis goes into either neighbour) are zero by choice."
    )
    return Table(columns, rows, caption, frozenset(range(1, 7)))


def views_table(result: HandEyeResult, judgement: HandEyeJudgement) -> Table:
    """Each view: residuals and held-out errors."""
    held_out, off = judgement.held_out, result.arm_residuals
    rms = [float(np.sqrt(np.mean(np.sum(r**2, axis=1)))) for r in result.predicted_residuals]
    order = range(len(rms)) if len(rms) <= MOST_ROWS else np.sort(np.argsort(held_out.shift_m)[-MOST_ROWS:])
    rows = tuple(
        (
            str(i + 1),
            result.names[i],
            str(len(result.corners[i])),
            f"{rms[i]:.2f}",
            f"{1e3 * np.linalg.norm(off[i, 3:]):.3f}",
            f"{np.degrees(np.linalg.norm(off[i, :3])):.4f}",
            f"{held_out.rms_px[i]:.2f}",
            f"{1e3 * held_out.at_board_m[i]:.3f}",
        )
        for i in order
    )
    only = f" The {MOST_ROWS} with the largest held-out shift are listed." if len(rms) > MOST_ROWS else ""
    columns = (
        "view",
        "picture",
        "corners",
        "rms [px]",
        "shift [mm]",
        "turn [°]",
        "held out [px]",
        "held out [mm]",
    )
    caption = (
        "Corners predicted from the arm's pose less seen; shift and turn of the wrist between arm and "
        "picture; the same "
        f"prediction with the view held out, in pixels and at the board.{only}"
    )
    return Table(columns, rows, caption, frozenset({0, 2, 3, 4, 5, 6, 7}))


def rejected_table(result: HandEyeResult) -> Table:
    """What was left out, and why."""
    rows = [(one.image, one.reason) for one in result.rejected if one.corner is None]
    single: dict[str, list[str]] = {}
    for one in result.rejected:
        if one.corner is not None:
            single.setdefault(one.image, []).append(str(one.corner))
    rows += [
        (image, f"corners {listed(ids, 12)}: farther off than noise explains")
        for image, ids in single.items()
    ]
    return Table(("picture", "reason"), tuple(rows[:MOST_ROWS]), "Left out of the calibration.")
