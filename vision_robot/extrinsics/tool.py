"""Tool centre point from camera observations: where the tip is on the wrist, seen by fixed cameras.

Hallenberg's problem ("Robot tool center point calibration using computer vision", 2007). At pose i the tip is
at ``base_from_wrist_i p``, seen by a camera at ``project(cam_from_base base_from_wrist_i p)``. Sought is
p, and with it cam_from_base of every camera whose place is not known beforehand. A tip held still at one
point while the wrist turns about it (the pivot method) is the same problem without cameras: `pivot`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.errors import BadParameter, NoConvergence
from vision_robot.extrinsics.board_pose import moved_pose, pose_jacobian
from vision_robot.extrinsics.descent import DenseEquations, dense_step, descend
from vision_robot.extrinsics.tip_view import TipView
from vision_robot.extrinsics.tool_checks import check_known, check_turns
from vision_robot.extrinsics.tool_start import start
from vision_robot.geometry import SE3
from vision_robot.types import Array, Bool, Float

__all__ = ["TipView", "ToolFit", "fit_tool"]

CUTOFF = 5.5
RAYLEIGH_MEDIAN = 1.1774
NEVER_OUTLYING_PX = 0.1
ROUNDS = 6


@dataclass(frozen=True)
class ToolFit:
    """The tip in the wrist's frame [m] with its covariance, and what is needed to judge it.

    `residuals` (cameras, poses, 2) are projected minus seen [px], NaN where a camera did not see the tip.
    """

    tip: Float[Array, "3"]
    covariance: Float[Array, "3 3"]
    cam_from_base: tuple[SE3, ...]
    views: tuple[TipView, ...]
    base_from_wrist: SE3
    residuals: Float[Array, "cameras poses 2"]
    noise_px: float
    degrees_of_freedom: int
    rejected: tuple[tuple[str, int], ...]
    """Camera and pose of sightings that noise cannot explain."""

    @property
    def wrist_from_tool(self) -> SE3:
        """The tool's frame at the tip, with the wrist's axes: a point has no direction of its own."""
        return SE3(np.eye(3), self.tip)

    @property
    def sigma(self) -> Float[Array, "3"]:
        """One standard deviation along the wrist's axes [m]."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def rms_px(self) -> float:
        """Root mean square residual per sighting, both axes together."""
        squared = np.sum(self.residuals**2, axis=2)
        return float(np.sqrt(np.nanmean(squared)))


@dataclass(frozen=True)
class _State:
    tip: Float[Array, "3"]
    cam_from_base: SE3


def fit_tool(base_from_wrist: SE3, views: Sequence[TipView], *, robust: bool = True) -> ToolFit:
    """The tip on the wrist from poses of the robot and where fixed cameras saw the tip.

    Args:
        base_from_wrist: The robot's poses (poses,).
        views: One for each camera.
        robust: Leave out sightings that noise cannot explain, and name them.

    Raises:
        BadParameter: Counts that do not fit, or too few sightings.
        TooLittleMotion: The poses leave a direction of the tip unknown; it is named.
        NoConvergence: No tip explains the pictures.
    """
    count = len(base_from_wrist)
    if not views:
        raise BadParameter("cameras", 0, "one or more")
    for view in views:
        if len(view.pixels) != count:
            what = f"sightings of camera {view.name}"
            raise BadParameter(what, len(view.pixels), f"{count}, one for each robot pose (NaN where unseen)")
    placed = np.array([view.cam_from_base is not None for view in views])
    seen = np.array([np.isfinite(view.pixels).all(axis=1) for view in views])
    unknowns = 3 + 6 * int((~placed).sum())
    for view, one, known in zip(views, seen, placed, strict=True):
        least = 1 if known else 6
        if one.sum() < least:
            raise BadParameter(f"sightings of camera {view.name}", int(one.sum()), f"at least {least}")
    if 2 * seen.sum() <= unknowns:
        raise BadParameter(
            "sightings", int(seen.sum()), f"more than {unknowns / 2:g} for {unknowns} unknowns"
        )
    check_turns(base_from_wrist[seen.any(axis=0)], placed=bool(placed.all()))
    tip, poses = start(base_from_wrist, views, seen)
    state = _State(tip, SE3(np.stack([p.rotation for p in poses]), np.stack([p.translation for p in poses])))
    rejected: list[tuple[str, int]] = []
    state, matrix, cost = _settle(state, base_from_wrist, views, seen, placed)
    for _ in range(ROUNDS):
        residuals = _residuals(state, base_from_wrist, views, seen)
        sigma = np.array([view.sigma_px for view in views])[:, None]
        length = np.linalg.norm(residuals, axis=2)
        spread = float(np.nanmedian(length / sigma)) / RAYLEIGH_MEDIAN
        dof = 2 * int(seen.sum()) - unknowns
        far = seen & (length / sigma > CUTOFF * spread * np.sqrt(2 * seen.sum() / max(dof, 1)))
        far &= length > NEVER_OUTLYING_PX
        if not robust or not far.any() or 2 * (seen & ~far).sum() - unknowns < 4:
            break
        # The farthest first: it pulls the others.
        worst = np.unravel_index(int(np.nanargmax(np.where(far, length / sigma, -1))), far.shape)
        rejected.append((views[int(worst[0])].name, int(worst[1])))
        seen[worst] = False
        state, matrix, cost = _settle(state, base_from_wrist, views, seen, placed)
    dof = max(2 * int(seen.sum()) - unknowns, 1)
    unit = 2 * cost / dof
    check_known(matrix[:3, :3], matrix, base_from_wrist)
    covariance = _covariance(state, base_from_wrist, views, seen, placed, matrix, unit)
    return ToolFit(
        tip=state.tip,
        covariance=covariance,
        cam_from_base=tuple(state.cam_from_base[i] for i in range(len(views))),
        views=tuple(views),
        base_from_wrist=base_from_wrist,
        residuals=_residuals(state, base_from_wrist, views, seen),
        noise_px=float(np.sqrt(unit) * np.mean([view.sigma_px for view in views])),
        degrees_of_freedom=dof,
        rejected=tuple(rejected),
    )


def _rows(
    state: _State, wrist: SE3, view: TipView, i: int, seen: Bool[Array, "poses"]
) -> tuple[Array, Array, Array, Array]:
    """Weighted residuals (n, 2) and derivatives in the tip, the camera's pose, its intrinsics."""
    in_base = wrist.apply(state.tip[None])[seen, 0]
    pose = state.cam_from_base[i]
    pixels, in_pose, in_camera, in_point = pose_jacobian(view.known.camera, pose, in_base)
    in_tip = in_point @ wrist.rotation[seen]
    weight = 1 / view.sigma_px
    return (pixels - view.pixels[seen]) * weight, in_tip * weight, in_pose * weight, in_camera * weight


def _settle(
    state: _State, wrist: SE3, views: Sequence[TipView], seen: Bool[Array, "c p"], placed: Bool[Array, "c"]
) -> tuple[_State, Float[Array, "k k"], float]:
    free = np.flatnonzero(~placed)
    unknowns = 3 + 6 * len(free)

    def evaluate(at: _State) -> DenseEquations:
        rows, residuals = [], []
        for i, view in enumerate(views):
            residual, in_tip, in_pose, _ = _rows(at, wrist, view, i, seen[i])
            J = np.zeros((*residual.shape, unknowns))
            J[:, :, :3] = in_tip
            if not placed[i]:
                first = 3 + 6 * int(np.searchsorted(free, i))
                J[:, :, first : first + 6] = in_pose
            rows.append(J.reshape(-1, unknowns))
            residuals.append(residual.reshape(-1))
        return DenseEquations.of(np.concatenate(rows), np.concatenate(residuals))

    def move(at: _State, step: Float[Array, "k"]) -> _State:
        steps = np.zeros((len(views), 6))
        steps[free] = step[3:].reshape(-1, 6)
        return replace(at, tip=at.tip + step[:3], cam_from_base=moved_pose(at.cam_from_base, steps))

    dof = max(2 * int(seen.sum()) - unknowns, 1)
    end = descend(
        state,
        evaluate=evaluate,
        solve=dense_step,
        move=move,
        variance=lambda found: 2 * found.cost / dof,
        what="the tool's tip",
        max_iterations=200,
    )
    if not np.isfinite(end.equations.cost):
        raise NoConvergence("no tip on the wrist explains where the cameras saw it")
    return end.state, end.equations.matrix, end.equations.cost


def _residuals(
    state: _State, wrist: SE3, views: Sequence[TipView], seen: Bool[Array, "c p"]
) -> Float[Array, "c p 2"]:
    residuals = np.full((*seen.shape, 2), np.nan)
    for i, view in enumerate(views):
        residuals[i, seen[i]] = _rows(state, wrist, view, i, seen[i])[0] * view.sigma_px
    return residuals


def _covariance(
    state: _State,
    wrist: SE3,
    views: Sequence[TipView],
    seen: Bool[Array, "c p"],
    placed: Bool[Array, "c"],
    matrix: Float[Array, "k k"],
    unit: float,
) -> Float[Array, "3 3"]:
    """Noise of the pixels, and what the held intrinsics and known places bring along."""
    free = np.flatnonzero(~placed)
    scale = 1 / np.sqrt(np.diag(matrix))
    inverse = scale[:, None] * np.linalg.inv(matrix * scale[:, None] * scale) * scale
    covariance = unit * inverse
    for i, view in enumerate(views):
        _, in_tip, in_pose, in_camera = _rows(state, wrist, view, i, seen[i])
        J = np.zeros((int(seen[i].sum()), 2, len(matrix)))
        J[:, :, :3] = in_tip
        if not placed[i]:
            first = 3 + 6 * int(np.searchsorted(free, i))
            J[:, :, first : first + 6] = in_pose
        J = J.reshape(-1, len(matrix))
        follow = -inverse @ J.T @ in_camera.reshape(len(J), -1)
        covariance = covariance + follow @ view.known.covariance @ follow.T
        if placed[i] and view.pose_covariance is not None:
            follow = -inverse @ J.T @ in_pose.reshape(len(J), 6)
            covariance = covariance + follow @ view.pose_covariance @ follow.T
    return covariance[:3, :3]
