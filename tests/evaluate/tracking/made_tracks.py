"""Small tables of tracks for the tests of tracking metrics."""

import numpy as np

from vision_robot.tracks import Tracks


def tracks(rows: list[tuple[int, int, float, float]], side: float = 10.0, **extra: list[float]) -> Tracks:
    """Tracks from (frame, id, u, v), each a square box of `side` pixels around its centroid."""
    table = np.array(rows, dtype=float).reshape(-1, 4)
    n, centroid = len(table), table[:, 2:]
    unknown = np.full((n, 2), np.nan)
    return Tracks(
        frame=table[:, 0],
        time_s=table[:, 0] / 10,
        id=table[:, 1],
        centroid_px=centroid,
        box_px=np.column_stack([centroid - side / 2, np.full((n, 2), side)]),
        area_px=np.full(n, side * side),
        axes_px=unknown,
        yaw_rad=np.full(n, np.nan),
        position_m=unknown,
        velocity_m_s=unknown,
        extra={name: np.array(column, dtype=float) for name, column in extra.items()},
    )


def wandering(seed: int) -> tuple[Tracks, Tracks]:
    """A truth of a few wandering squares, and an answer that misses, invents and swaps."""
    rng = np.random.default_rng(seed)
    truth, answer = [], []
    labels = rng.permutation(9)
    for frame in range(int(rng.integers(3, 25))):
        for one in range(int(rng.integers(0, 5))):
            place = rng.uniform(0, 40, 2)
            truth.append((frame, one, *place))
            if rng.random() < 0.8:
                answer.append((frame, labels[one], *(place + rng.normal(0, 2.0, 2))))
        if rng.random() < 0.3:
            answer.append((frame, 20 + int(rng.integers(3)), *rng.uniform(0, 40, 2)))
        if rng.random() < 0.2:
            labels = rng.permutation(9)
    return tracks(truth), tracks(answer)
