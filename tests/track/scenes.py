"""Short videos with truth: what stands where in each frame."""

from collections.abc import Callable, Sequence

import numpy as np

from tests.track.drawn import Shape, frame_of, table
from vision_robot.track import Blobs, LooksAhead, Tracker

SIZE = (240, 180)
FPS = 25.0
RED, GREEN, BLUE = (40, 40, 200), (60, 160, 50), (190, 80, 40)

Scene = Callable[[int], Sequence[Shape]]


def moving(k: int) -> list[Shape]:
    """A red rod that turns as it crosses, and a green disc that comes the other way, clear of it."""
    return [
        Shape(30 + 1.7 * k, 45 + 0.2 * k, 44, 8, 0.04 * k, RED),
        Shape(215 - 1.6 * k, 130 + 8 * np.sin(k / 9), 20, 20, 0, GREEN),
    ]


def rendered(scene: Scene, count: int, *, noise: float = 2.0, gain: Callable[[int], float] = lambda _: 1.0):
    """The frames of a scene."""
    background = table(SIZE)
    return [frame_of(background, scene(k), noise=noise, seed=k, gain=gain(k)) for k in range(count)]


def stepped(tracker: Tracker, frames: Sequence[np.ndarray], *, ahead: bool = True) -> list[Blobs]:
    """Blobs of all frames, having looked ahead as a recorded video allows."""
    if ahead and isinstance(tracker, LooksAhead):
        tracker.learn((frame, k / FPS) for k, frame in enumerate(frames))
    return [tracker.step(frame, k / FPS) for k, frame in enumerate(frames)]


def errors(seen: Sequence[Blobs], scene: Scene, *, within_px: float = 4.0) -> tuple[np.ndarray, int, int]:
    """Distances of the blobs to the shapes they show [px], shapes missed, blobs that show none."""
    found, missed, extra = [], 0, 0
    for k, blobs in enumerate(seen):
        shapes = scene(k)
        truth = np.array([(one.u, one.v) for one in shapes]).reshape(-1, 2)
        apart = np.linalg.norm(truth[:, None] - blobs.centroid_px[None], axis=2)
        near = apart.min(axis=1) if len(blobs) and len(truth) else np.full(len(truth), np.inf)
        found += near[near < within_px].tolist()
        missed += int((near >= within_px).sum())
        extra += len(blobs) - int((near < within_px).sum())
    return np.array(found), missed, extra
