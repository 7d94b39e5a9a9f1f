"""Three cameras around a place where a board is held: pictures, and where everything is."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from vision_robot.calibrate.boards import Board, Chessboard
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, CameraRig
from vision_robot.sim.board_scene import render_views
from vision_robot.types import Image
from vision_robot_synth.calibration import board_print
from vision_robot_synth.sensor import Sensor

__all__ = ["RigSet", "rig_set"]

CAMERAS = (
    Camera(960, 720, 790.3, 786.1, 483.2, 355.4, 0, "brown5", (-0.2, 0.07, 4e-4, -3e-4, -0.01)),
    Camera(960, 720, 812.7, 809.9, 474.6, 362.8, 0, "brown5", (-0.22, 0.08, -2e-4, 3e-4, -0.01)),
    Camera(960, 720, 768.9, 770.2, 481.5, 350.1, 0, "brown5", (-0.18, 0.05, 1e-4, 2e-4, 0.0)),
)
NAMES = ("left", "right", "top")


@dataclass(frozen=True)
class RigSet:
    """A rig, and a board held at one place after the other; all cameras take their pictures together."""

    rig: CameraRig
    board: Board
    rig_from_board: SE3
    seed: int
    sensor: Sensor = field(default_factory=Sensor)

    def __len__(self) -> int:
        return len(self.rig_from_board)

    def images(self, index: int) -> Iterator[tuple[str, Image]]:
        """The pictures of one camera by moment; those that do not show the whole board are left out."""
        camera, pose = self.rig.cameras[index], self.rig.cam_from_rig[index]
        (x, y), (width, height) = self.board.origin_m, self.board.size_m
        edge = np.array([[u - x, v - y, 0.0] for u in (0, width) for v in (0, height)])
        poses = pose @ self.rig_from_board
        shown = [k for k in range(len(self)) if camera.sees(poses[k].apply(edge)).all()]
        clean = render_views(board_print(self.board), camera, poses[np.array(shown)], multisamples=0)
        for k, image in zip(shown, clean, strict=True):
            yield f"{k:04d}", self.sensor.expose(image, np.random.default_rng([self.seed, 3, index, k]))


def rig_set(board: Board | None = None, *, moments: int = 16, seed: int = 0) -> RigSet:
    """Three cameras that look at one place, and a board tilted and turned about it; the same for a seed.

    Raises BadParameter where a board does not fit into two of the pictures.
    """
    board = board or Chessboard(9, 6, 0.025)
    rng = np.random.default_rng([seed, 23])
    points = board.points
    size = float(np.ptp(points[:, :2], axis=0).max())
    middle = np.array([0.25 * size, 0.0, 2.9 * size])
    eyes = size * np.array([[0.0, 0.0, 0.0], [1.5, 0.1, 0.2], [0.5, -1.4, 0.3]])
    poses = [_looking(eye, middle) for eye in eyes]
    # The rig's frame is the first camera's.
    first = poses[0].inverse()
    stand = [pose @ first for pose in poses]
    target = poses[0].apply(middle[None])[0]
    places: list[SE3] = []
    cam_from_rig = SE3(np.stack([p.rotation for p in stand]), np.stack([p.translation for p in stand]))
    for _ in range(200 * moments):
        if len(places) == moments:
            break
        turn = SE3.from_rotvec(rng.normal(size=3) * [0.3, 0.3, 0.4], np.zeros(3)).rotation
        held = target + size * rng.uniform([-0.55, -0.4, -0.5], [0.55, 0.4, 0.6])
        place = SE3(turn, held - turn @ points.mean(axis=0))
        seen = [
            camera.sees((cam_from_rig[i] @ place).apply(points)).all() for i, camera in enumerate(CAMERAS)
        ]
        if sum(seen) >= 2:
            places.append(place)
    if len(places) < moments:
        raise BadParameter("board", board.size, "one that fits into the pictures of two cameras")
    held_at = SE3(np.stack([p.rotation for p in places]), np.stack([p.translation for p in places]))
    return RigSet(CameraRig.exact(NAMES, CAMERAS, cam_from_rig), board, held_at, seed)


def _looking(eye: np.ndarray, target: np.ndarray) -> SE3:
    """cam_from_room of an upright camera; the room's y is down."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross([0, 1.0, 0], forward)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    return SE3(rotation, -rotation @ eye)
