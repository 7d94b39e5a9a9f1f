"""Three cameras around a board that moves, with exact truth."""

from dataclasses import dataclass

import numpy as np

from tests.extrinsics.table import BOARD
from vision_robot.calibrate import Corners
from vision_robot.geometry import SE3, Camera, CameraRig

CAMERAS = (
    Camera(1280, 960, 1000, 1010, 650, 470, 0, "brown5", (-0.28, 0.09, 1e-3, -5e-4, -0.01)),
    Camera(1280, 960, 1100, 1100, 630, 480, 0, "brown5", (-0.2, 0.05, 0, 0, 0)),
    Camera(1280, 960, 950, 955, 640, 475, 0, "brown5", (-0.1, 0.02, 1e-4, 0, 0)),
)
NAMES = ("left", "right", "top")
TARGET = np.array([0.05, 0.0, 0.8])


def looking(eye: tuple[float, float, float]) -> SE3:
    """cam_from_rig of an upright camera at `eye` that looks at the target."""
    forward = (TARGET - eye) / np.linalg.norm(TARGET - eye)
    right = np.cross([0, 1.0, 0], forward)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    return SE3(rotation, -rotation @ eye)


_EYES = [looking(eye) for eye in ((0.3, 0.0, 0.05), (0.1, -0.3, 0.08))]
STAND = SE3(
    np.stack([np.eye(3), *(one.rotation for one in _EYES)]),
    np.stack([np.zeros(3), *(one.translation for one in _EYES)]),
)
RIG = CameraRig.exact(NAMES, CAMERAS, STAND)


@dataclass(frozen=True)
class Boards:
    """Where the board was, and what each camera saw of it."""

    rig_from_board: SE3
    sightings: list[dict[str, Corners]]


def boards(count: int = 12, *, noise_px: float = 0.2, seed: int = 0, names: str = "{:02d}.png") -> Boards:
    """A board held at `count` places before the rig; a camera reports it where it sees all of it."""
    rng = np.random.default_rng(seed)
    sightings: list[dict[str, Corners]] = [{} for _ in CAMERAS]
    poses = []
    while len(poses) < count:
        rotvec = rng.normal(size=3) * 0.35
        turn = SE3.from_rotvec(rotvec, np.zeros(3)).rotation
        middle = np.array([rng.uniform(-0.1, 0.2), rng.uniform(-0.15, 0.15), rng.uniform(0.65, 1.0)])
        pose = SE3(turn, middle - turn @ BOARD.mean(axis=0))
        seen = [camera.sees((STAND[i] @ pose).apply(BOARD)).all() for i, camera in enumerate(CAMERAS)]
        if sum(seen) < 2:
            continue
        for i, camera in enumerate(CAMERAS):
            if seen[i]:
                pixels = camera.project((STAND[i] @ pose).apply(BOARD))
                noisy = pixels + rng.normal(size=pixels.shape) * noise_px
                name = names.format(len(poses))
                sightings[i][name] = Corners(f"{NAMES[i]}/{name}", np.arange(len(BOARD)), noisy)
        poses.append(pose)
    rotations, translations = (
        np.stack([getattr(p, part) for p in poses]) for part in ("rotation", "translation")
    )
    return Boards(SE3(rotations, translations), sightings)
