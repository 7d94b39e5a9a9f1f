"""The synthetic calibration set: a board photographed in MuJoCo, every truth known."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from vision_robot.calibrate.boards import Board, Chessboard, raster
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera
from vision_robot.sim.board_scene import BoardPrint, render_views
from vision_robot.sim.viewpoints import board_poses
from vision_robot.types import Array, Float, Image
from vision_robot_synth.sensor.still import Sensor

__all__ = ["TRUTH", "CalibrationSet", "board_print", "calibration_set"]

TRUTH = Camera(
    1280, 960, 1021.3, 1012.8, 655.7, 466.4, model="brown5", distortion=(-0.25, 0.09, 0.0006, -0.0004, -0.01)
)
"""An ordinary lens: principal point off-centre, focal lengths unequal, a quarter of barrel distortion."""

PITCH_PX = 128
"""Pixels of print per square: a power of two, see `BoardPrint`."""
LARGEST_PRINT = 4096


@dataclass(frozen=True)
class CalibrationSet:
    """Views of one board by one camera, with the truth; pictures are rendered when asked for."""

    camera: Camera
    board: Board
    cam_from_board: SE3
    seed: int
    sensor: Sensor = field(default_factory=Sensor)

    def __len__(self) -> int:
        return len(self.cam_from_board)

    @property
    def corners(self) -> Float[Array, "views n 2"]:
        """True pixels of all board points in each view; NaN where the camera does not see one."""
        return self.camera.project(self.cam_from_board.apply(self.board.points))

    def images(self, views: slice = slice(None)) -> Iterator[Image]:
        """The grey pictures of `views`, the same at every call."""
        wanted = range(len(self))[views]
        if not wanted:
            return
        poses = self.cam_from_board[np.array(wanted)]
        # A lens is rendered larger and averaged down, which smooths outlines by itself.
        multisamples = 4 if self.camera.model == "pinhole" and self.camera.skew == 0 else 0
        clean = render_views(board_print(self.board), self.camera, poses, multisamples=multisamples)
        for view, image in zip(wanted, clean, strict=True):
            yield self.sensor.expose(image, np.random.default_rng([self.seed, view]))


def calibration_set(
    camera: Camera | None = None,
    board: Board | None = None,
    *,
    views: int = 24,
    seed: int = 0,
    sensor: Sensor | None = None,
) -> CalibrationSet:
    """Board views as a careful person would take them, seen by `camera` (default `TRUTH`).

    The default board is a chessboard of 9 x 6 inner corners with 25 mm squares, the default
    sensor has a little blur and noise; the same seed gives the same set. Raises BadParameter
    for a negative seed, no views, or a camera no whole board fits into.
    """
    if seed < 0:
        raise BadParameter("seed", seed, "zero or a positive whole number")
    camera = camera or TRUTH
    board = board or Chessboard(9, 6, 0.025)
    poses = board_poses(camera, board_print(board).box_m, views, seed=seed)
    return CalibrationSet(camera, board, poses, seed, sensor or Sensor())


def board_print(board: Board) -> BoardPrint:
    """The board's drawing as the texture of the rendered board."""
    points = board.points
    pitch = np.linalg.norm(points[1:] - points[0], axis=1).min()
    scale = PITCH_PX / pitch
    while max(board.size_m) * scale > LARGEST_PRINT:
        scale /= 2
    return BoardPrint(raster(board.drawing(), scale), scale, board.origin_m)
