"""One bundle over cameras of a rig, boards seen by some of them at each moment, and the board's shape.

Shared unknowns, in the order of `CameraRig.covariance`: for each camera its intrinsics and the
perturbation (w, dt) of cam_from_rig; then the board's warp. Each moment has the pose rig_from_board. A
moment's errors depend on no other moment's pose, so the boards are eliminated by the Schur complement, with
the arrow-shaped equations of `calibrate.normal_equations`.
"""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.normal_equations import NormalEquations
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.refine import arrow_solve
from vision_robot.calibrate.warp import Warp
from vision_robot.extrinsics.board_pose import moved_pose
from vision_robot.extrinsics.descent import Descent, descend
from vision_robot.geometry import SE3, Camera
from vision_robot.types import Array, Bool, Float, Int

__all__ = ["RigProblem", "RigState", "restricted", "settle_rig"]

ArrowStep = tuple[Float[Array, "f"], Float[Array, "moments 6"]]


@dataclass(frozen=True)
class RigState:
    """Cameras, where they stand, where the boards stood, and the board's shape."""

    cameras: tuple[Camera, ...]
    cam_from_rig: SE3
    rig_from_board: SE3
    warp: Warp

    @property
    def sizes(self) -> list[int]:
        """Shared unknowns of each camera."""
        return [len(camera.parameters) + 6 for camera in self.cameras]

    def moved(self, free: Bool[Array, "s"], step: ArrowStep) -> "RigState | None":
        """The state after a step; None where it is no camera any more."""
        shared = np.zeros(len(free))
        shared[free] = step[0]
        cameras, first = [], 0
        pose_steps = np.zeros((len(self.cameras), 6))
        for i, (camera, size) in enumerate(zip(self.cameras, self.sizes, strict=True)):
            rows = shared[first : first + size]
            parameters = camera.parameters + rows[:-6]
            if not np.isfinite(parameters).all() or parameters[:2].min() <= 0:
                return None
            cameras.append(camera.with_parameters(parameters))
            pose_steps[i] = rows[-6:]
            first += size
        return RigState(
            tuple(cameras),
            moved_pose(self.cam_from_rig, pose_steps),
            moved_pose(self.rig_from_board, step[1]),
            replace(self.warp, coefficients=self.warp.coefficients + shared[first:]),
        )


@dataclass(frozen=True)
class RigProblem:
    """What was seen, by camera: padded corners and the moment of each view; and what is free.

    `prior` (s, s) is information on the shared unknowns about `prior_mean`, in units of the weights.
    """

    seen: tuple[Observations, ...]
    moments: tuple[Int[Array, "_"], ...]
    moment_count: int
    free: Bool[Array, "s"]
    prior: Float[Array, "s s"]
    prior_mean: tuple[Camera, ...]

    @property
    def degrees_of_freedom(self) -> int:
        """Measured numbers less estimated ones."""
        measured = sum(2 * int(np.count_nonzero(one.weight)) for one in self.seen)
        measured += int(np.count_nonzero(np.diag(self.prior)))
        return measured - int(self.free.sum()) - 6 * self.moment_count

    def residuals(self, state: RigState) -> list[Float[Array, "views 2 n"]]:
        """Projected minus seen [px] of each camera; zero in the padding."""
        return [self._view(state, i)[-1] for i in range(len(self.seen))]

    def _points(self, state: RigState, i: int) -> tuple[Array, Array, Array]:
        seen, moments = self.seen[i], self.moments[i]
        board = seen.points + (
            state.warp.displacement.T[:, seen.ids].transpose(1, 0, 2) if len(state.warp) else 0
        )
        turned = state.rig_from_board.rotation[moments] @ board
        in_rig = turned + state.rig_from_board.translation[moments][..., None]
        return turned, in_rig, state.cam_from_rig.rotation[i] @ in_rig

    def _view(self, state: RigState, i: int) -> tuple[Array, Array, Array, Array, Array]:
        seen, camera = self.seen[i], state.cameras[i]
        turned, _, arm = self._points(state, i)
        views, _, n = arm.shape
        in_cam = arm + state.cam_from_rig.translation[i][:, None]
        flat = in_cam.transpose(0, 2, 1).reshape(-1, 3)
        pixels, in_point, in_camera = camera.project_jacobian(flat)
        error = pixels.reshape(views, n, 2).transpose(0, 2, 1) - seen.pixels
        error = np.where(seen.present[:, None], error, 0.0)
        return turned, arm, in_point.reshape(views, n, 2, 3), in_camera.reshape(views, n, 2, -1), error

    def equations(self, state: RigState) -> NormalEquations:
        """Cost, gradient and Gauss-Newton matrix over all shared unknowns, free or not."""
        s, moments = len(self.free), self.moment_count
        shared, shared_gradient = np.zeros((s, s)), np.zeros(s)
        border, pose = np.zeros((moments, s, 6)), np.zeros((moments, 6, 6))
        pose_gradient, total, first = np.zeros((moments, 6)), 0.0, 0
        warp_rows = slice(s - len(state.warp), s)
        for i, size in enumerate(state.sizes):
            seen, rows = self.seen[i], slice(first, first + size)
            first += size
            if not seen.views:
                continue
            turned, arm, in_point, in_camera, error = self._view(state, i)
            if not np.isfinite(error).all():
                total = np.inf
                break
            to_rig = in_point @ state.cam_from_rig.rotation[i]
            J = np.concatenate(
                [
                    in_camera,
                    _turning(in_point, arm),
                    in_point,
                    *self._in_warp(state, i, to_rig),
                    _turning(to_rig, turned),
                    to_rig,
                    error.transpose(0, 2, 1)[..., None],
                ],
                axis=3,
            )
            J = np.where(seen.present[:, :, None, None], J, 0.0) * seen.weight[:, :, None, None]
            J = J.reshape(seen.views, -1, J.shape[-1])
            full = J.transpose(0, 2, 1) @ J
            k = np.r_[rows, warp_rows]
            own, board = slice(0, len(k)), slice(len(k), len(k) + 6)
            shared[np.ix_(k, k)] += full[:, own, own].sum(axis=0)
            shared_gradient[k] += full[:, own, -1].sum(axis=0)
            # A camera sees the board at most once a moment, so plain indexing adds every view.
            into = self.moments[i]
            border[into[:, None], k] += full[:, own, board]
            pose[into] += full[:, board, board]
            pose_gradient[into] += full[:, board, -1]
            total += float(full[:, -1, -1].sum())
        off = self._off(state)
        shared += self.prior
        shared_gradient += self.prior @ off
        cost = 0.5 * (total + float(off @ self.prior @ off))
        return NormalEquations(cost, shared, border, pose, shared_gradient, pose_gradient)

    def _off(self, state: RigState) -> Float[Array, "s"]:
        off = np.zeros(len(self.free))
        first = 0
        for camera, mean, size in zip(state.cameras, self.prior_mean, state.sizes, strict=True):
            off[first : first + size - 6] = camera.parameters - mean.parameters
            first += size
        return off

    def _in_warp(self, state: RigState, i: int, to_rig: Array) -> list[Array]:
        if not len(state.warp):
            return []
        in_board = to_rig @ state.rig_from_board.rotation[self.moments[i]][:, None]
        fields = state.warp.basis[:, :, self.seen[i].ids].transpose(2, 3, 1, 0)
        return [in_board @ fields]


def _turning(in_point: Float[Array, "views n 2 3"], arm: Float[Array, "views 3 n"]) -> Array:
    """d(Exp(w) x)/dw = -[x]_x: the row a of the point's Jacobian becomes x x a."""
    return np.cross(arm.transpose(0, 2, 1)[:, :, None], in_point)


def settle_rig(
    state: RigState, problem: RigProblem, *, tolerance: float = 3e-3
) -> Descent[RigState, NormalEquations]:
    """Minimise over all free unknowns and boards; raises NoConvergence."""
    free = problem.free

    def solve(equations: NormalEquations, damping: float) -> tuple[ArrowStep, float]:
        part = restricted(equations, free)
        shared, poses = arrow_solve(part, damping)
        # (H + damping D) s = -g, so the model's decrease -g.s - s.H.s / 2 is -g.s / 2 + damping s.D.s / 2.
        weighed = float(shared @ (np.diag(part.shared) * shared))
        weighed += float(np.sum(np.diagonal(part.pose, axis1=1, axis2=2) * poses**2))
        slope = float(part.shared_gradient @ shared + np.sum(part.pose_gradient * poses))
        return (shared, poses), 0.5 * (damping * weighed - slope)

    return descend(
        state,
        evaluate=problem.equations,
        solve=solve,
        move=lambda at, step: at.moved(free, step),
        variance=lambda found: 2 * found.cost / max(problem.degrees_of_freedom, 1),
        what="the rig",
        tolerance=tolerance * max(1.0, np.sqrt((int(free.sum()) + 6 * problem.moment_count) / 100)),
    )


def restricted(equations: NormalEquations, free: Bool[Array, "s"]) -> NormalEquations:
    """The equations of some of the shared unknowns."""
    return NormalEquations(
        equations.cost,
        equations.shared[np.ix_(free, free)],
        equations.border[:, free],
        equations.pose,
        equations.shared_gradient[free],
        equations.pose_gradient,
    )
