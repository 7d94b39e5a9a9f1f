"""A camera over a table on which a board lies in several places: pictures, and where everything is."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from vision_robot.calibrate.boards import Board, Chessboard
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera
from vision_robot.sim.board_scene import render_views
from vision_robot.types import Image
from vision_robot_synth.calibration import TRUTH, board_print
from vision_robot_synth.sensor import Sensor

__all__ = ["TableSet", "looking_at", "table_set"]

HEIGHT_M = 0.003
"""Of the printed face over the table."""


@dataclass(frozen=True)
class TableSet:
    """One fixed camera, and the board at several places of the table; the first place defines {S}."""

    camera: Camera
    board: Board
    cam_from_station: SE3
    station_from_board: SE3
    seed: int
    sensor: Sensor = field(default_factory=Sensor)

    def __len__(self) -> int:
        return len(self.station_from_board)

    def images(self) -> Iterator[Image]:
        """The grey pictures, the same at every call."""
        poses = self.cam_from_station @ self.station_from_board
        clean = render_views(board_print(self.board), self.camera, poses, multisamples=0)
        for view, image in enumerate(clean):
            yield self.sensor.expose(image, np.random.default_rng([self.seed, 7, view]))


def looking_at(target_m: tuple[float, float], distance_m: float, elevation: float, azimuth: float) -> SE3:
    """cam_from_station of an upright camera that looks at a point of the table; angles in rad."""
    from_target = np.array(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    )
    eye = np.array([*target_m, 0.0]) + distance_m * from_target
    right = np.cross(-from_target, [0, 0, 1.0])
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(-from_target, right), -from_target])
    return SE3(rotation, -rotation @ eye)


def table_set(
    camera: Camera | None = None, board: Board | None = None, *, places: int = 4, seed: int = 0
) -> TableSet:
    """A board laid on a table within the camera's view, its first place at the middle, unturned.

    The same seed gives the same set. Raises BadParameter where no whole board fits into the picture.
    """
    camera, board = camera or TRUTH, board or Chessboard(9, 6, 0.025)
    rng = np.random.default_rng([seed, 11])
    points = board.points
    size = float(np.ptp(points[:, :2], axis=0).max())
    distance = 2.2 * size * camera.fx / camera.width
    elevation, azimuth = np.radians(rng.uniform(48, 62)), np.radians(rng.uniform(-110, -70))
    pose = looking_at((0.0, 0.0), distance, elevation, azimuth)
    laid = [_laid(points, 0.0, 0.0, 0.0)]
    for _ in range(4000):
        if len(laid) >= places:
            break
        x, y = rng.uniform(-1.2, 1.2, 2) * size
        place = _laid(points, x, y, rng.uniform(-np.pi, np.pi))
        if camera.sees((pose @ place).apply(_edge(board))).all():
            laid.append(place)
    if len(laid) < places or not camera.sees((pose @ laid[0]).apply(_edge(board))).all():
        raise BadParameter("board", board.size, "one that fits into the picture of the table")
    places_of = SE3(np.stack([p.rotation for p in laid]), np.stack([p.translation for p in laid]))
    return TableSet(camera, board, pose, places_of, seed)


def _laid(points: np.ndarray, x: float, y: float, yaw: float) -> SE3:
    """station_from_board with the board's middle at (x, y), face up."""
    turn = SE3.from_rotvec(np.array([0, 0, yaw]), np.zeros(3)).rotation @ np.diag([1.0, -1.0, -1.0])
    middle = turn @ points.mean(axis=0)
    return SE3(turn, np.array([x, y, HEIGHT_M]) - [middle[0], middle[1], 0.0])


def _edge(board: Board) -> np.ndarray:
    (x, y), (width, height) = board.origin_m, board.size_m
    return np.array([[u - x, v - y, 0.0] for u in (0, width / 2, width) for v in (0, height / 2, height)])
