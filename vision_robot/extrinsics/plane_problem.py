"""One camera, one table, boards lying anywhere on it: unknowns, Jacobian, descent."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.extrinsics.board_pose import BoardPose, moved_pose, pose_jacobian
from vision_robot.extrinsics.descent import DenseEquations, dense_step, descend
from vision_robot.geometry import SE3, Camera, rotation_log
from vision_robot.types import Array, Float

__all__ = ["PlaneState", "settle_plane"]


@dataclass(frozen=True)
class PlaneState:
    """cam_from_station, and (x, y, yaw) by which each board that was moved was shifted on the table.

    Unknowns in this order: (w, dt) of the pose, then (dx, dy, dyaw) of each of `moved`.
    """

    cam_from_station: SE3
    station_from_board: SE3
    moved: tuple[int, ...]
    """Views whose board lies elsewhere than the first view's."""
    shifts: Float[Array, "k 3"]

    @classmethod
    def starting(
        cls, poses: Sequence[BoardPose], moved: Sequence[int], station_from_board: SE3
    ) -> "PlaneState":
        """From each board's own pose: the table is the first one's, the others are laid onto it."""
        first = poses[0].cam_from_board @ station_from_board.inverse()
        shifts = np.zeros((len(moved), 3))
        for row, i in enumerate(moved):
            shift = first.inverse() @ poses[i].cam_from_board @ station_from_board.inverse()
            shifts[row] = [*shift.translation[:2], rotation_log(shift.rotation)[2]]
        return cls(first, station_from_board, tuple(moved), shifts)

    def station_from(self, view: int) -> SE3:
        """station_from_board of a view's board."""
        if view not in self.moved:
            return self.station_from_board
        x, y, yaw = self.shifts[self.moved.index(view)]
        return SE3.from_rotvec(np.array([0, 0, yaw]), np.array([x, y, 0])) @ self.station_from_board

    def in_station(self, view: int, on_board: Float[Array, "n 3"]) -> Float[Array, "n 3"]:
        """Where a view's points lie in {S}."""
        return self.station_from(view).apply(on_board)

    def rows(
        self, view: int, in_pose: Float[Array, "n 2 6"], points: Float[Array, "n 3"]
    ) -> Float[Array, "2*n k"]:
        """The Jacobian of a view's pixels in all unknowns; `points` are in {S}."""
        n = len(points)
        J = np.zeros((n, 2, 6 + 3 * len(self.moved)))
        J[:, :, :6] = in_pose
        if view in self.moved:
            first = 6 + 3 * self.moved.index(view)
            # The last three columns of in_pose are the derivative in the point, in the camera's axes.
            on_table = in_pose[:, :, 3:] @ self.cam_from_station.rotation
            x, y, _ = self.shifts[self.moved.index(view)]
            arm = points[:, :2] - [x, y]
            J[:, :, first : first + 2] = on_table[:, :, :2]
            J[:, :, first + 2] = on_table[:, :, 1] * arm[:, :1] - on_table[:, :, 0] * arm[:, 1:]
        return J.reshape(2 * n, -1)

    def stepped(self, step: Float[Array, "k"]) -> "PlaneState":
        """The state after a step of all unknowns."""
        pose = moved_pose(self.cam_from_station, step[:6])
        return replace(self, cam_from_station=pose, shifts=self.shifts + step[6:].reshape(-1, 3))


def settle_plane(
    camera: Camera, state: PlaneState, views: Sequence[Corners], on_board: Sequence[Float[Array, "_ 3"]]
) -> tuple[PlaneState, DenseEquations]:
    """The least-squares minimum over the pose and all shifts; raises NoConvergence."""
    size = 6 + 3 * len(state.moved)
    measured = 2 * sum(len(view) for view in views)

    def evaluate(at: PlaneState) -> DenseEquations:
        rows, residuals = [], []
        for i, view in enumerate(views):
            points = at.in_station(i, on_board[i])
            pixels, in_pose, _, _ = pose_jacobian(camera, at.cam_from_station, points)
            weight = np.repeat(1 / view.sigma_px, 2)
            rows.append(at.rows(i, in_pose, points) * weight[:, None])
            residuals.append((pixels - view.pixels).reshape(-1) * weight)
        return DenseEquations.of(np.concatenate(rows), np.concatenate(residuals))

    end = descend(
        state,
        evaluate=evaluate,
        solve=dense_step,
        move=PlaneState.stepped,
        variance=lambda found: 2 * found.cost / max(measured - size, 1),
        what="the work plane",
    )
    return end.state, end.equations
