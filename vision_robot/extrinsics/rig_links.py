"""Which cameras of a rig saw the same board at the same moment, and where that puts them."""

from collections.abc import Mapping, Sequence

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.errors import UnlinkedCameras, Unsynchronised
from vision_robot.extrinsics.board_pose import BoardPose
from vision_robot.geometry import SE3, KnownCamera, rotation_log
from vision_robot.types import Array, Float

__all__ = ["Poses", "Sightings", "common_moments", "starting_poses"]

Sightings = Sequence[Mapping[str, Corners]]
"""For each camera what it saw, by the name of the moment."""

Poses = Sequence[Mapping[str, BoardPose]]

CLOSE_PX = 3.0
CLOSE_SHARE = 0.03
"""A board carried from one camera to another agrees within these pixels, or this share of its size."""

AGREEING = 0.6
"""Share of common moments that must agree."""

SHIFTS = (1, -1, 2, -2, 3, -3, 4, -4, 5, -5)
"""Pictures by which one camera may lag behind another."""


def common_moments(sightings: Sequence[Mapping[str, object]], i: int, j: int) -> list[str]:
    """Moments at which both cameras saw the board."""
    return [name for name in sightings[i] if name in sightings[j]]


def starting_poses(
    names: Sequence[str],
    cameras: Sequence[KnownCamera],
    sightings: Sightings,
    poses: Poses,
    board_points: Float[Array, "m 3"],
) -> tuple[list[SE3], list[tuple[str, str, float]]]:
    """cam_from_rig of each camera, the first's frame being the rig's, along the best-linked pairs.

    Also the moments at which a pair of cameras disagrees, with the disagreement in px. Raises
    UnlinkedCameras naming those that share no moment with the others, and Unsynchronised where a pair
    agrees at too few moments.
    """
    count = len(names)
    found: dict[int, SE3] = {0: SE3.identity()}
    odd: list[tuple[str, str, float]] = []
    while len(found) < count:
        pairs = [
            (len(common_moments(sightings, i, j)), i, j)
            for i in found
            for j in range(count)
            if j not in found
        ]
        shared, i, j = max(pairs, key=lambda pair: pair[0])
        if shared == 0:
            linked = [names[k] for k in sorted(found)]
            raise UnlinkedCameras(linked, [name for name in names if name not in linked])
        moments = common_moments(sightings, i, j)
        steps = [(poses[i][m].cam_from_board, poses[j][m].cam_from_board) for m in moments]
        step, error = _consensus(steps, cameras[j], [sightings[j][m] for m in moments], board_points)
        agrees = error <= _allowed([sightings[j][m] for m in moments])
        if agrees.mean() < AGREEING:
            lag = _lag(sightings, poses, cameras[j], i, j, board_points)
            raise Unsynchronised(names[i], names[j], int(agrees.sum()), len(moments), lag)
        odd += [
            (m, names[j], float(e)) for m, e, good in zip(moments, error, agrees, strict=True) if not good
        ]
        found[j] = step @ found[i]
    return [found[k] for k in range(count)], odd


def _consensus(
    steps: list[tuple[SE3, SE3]], other: KnownCamera, seen: list[Corners], board_points: Float[Array, "m 3"]
) -> tuple[SE3, Float[Array, "k"]]:
    """The j-from-i that most moments agree with, averaged over those, and each moment's error [px]."""
    candidates = [second @ first.inverse() for first, second in steps]
    tried = candidates if len(candidates) <= MOST_TRIED else candidates[:: len(candidates) // MOST_TRIED]
    errors = [_transfer(one, steps, other, seen, board_points) for one in tried]
    best = int(np.argmin([np.median(error) for error in errors]))
    agrees = errors[best] <= max(float(np.median(errors[best])), 1e-9) * 2
    step = _mean([one for one, good in zip(candidates, agrees, strict=True) if good])
    averaged = _transfer(step, steps, other, seen, board_points)
    if np.median(averaged) <= np.median(errors[best]):
        return step, averaged
    return tried[best], errors[best]


MOST_TRIED = 25


def _transfer(
    step: SE3,
    steps: list[tuple[SE3, SE3]],
    other: KnownCamera,
    seen: list[Corners],
    board_points: Float[Array, "m 3"],
) -> Float[Array, "k"]:
    """Rms distance [px] between the board as the other camera saw it, and as the first one foretells."""
    errors = []
    for (first, _), view in zip(steps, seen, strict=True):
        pixels = other.camera.project((step @ first).apply(board_points[view.ids]))
        off = np.linalg.norm(pixels - view.pixels, axis=1)
        errors.append(np.inf if np.isnan(off).any() else float(np.sqrt(np.mean(off**2))))
    return np.array(errors)


def _allowed(seen: Sequence[Corners]) -> Float[Array, "k"]:
    spans = np.array([np.linalg.norm(np.ptp(view.pixels, axis=0)) for view in seen])
    return np.maximum(CLOSE_PX, CLOSE_SHARE * spans)


def _lag(
    sightings: Sightings,
    poses: Poses,
    other: KnownCamera,
    i: int,
    j: int,
    board_points: Float[Array, "m 3"],
) -> int | None:
    """By how many pictures camera j runs behind camera i, where one shift makes them agree."""
    order = sorted({*sightings[i], *sightings[j]})
    for shift in SHIFTS:
        pairs = [
            (order[k], order[k + shift])
            for k in range(len(order))
            if 0 <= k + shift < len(order) and order[k] in sightings[i] and order[k + shift] in sightings[j]
        ]
        if len(pairs) < 4:
            continue
        steps = [(poses[i][a].cam_from_board, poses[j][b].cam_from_board) for a, b in pairs]
        seen = [sightings[j][b] for _, b in pairs]
        _, error = _consensus(steps, other, seen, board_points)
        if (error <= _allowed(seen)).mean() > AGREEING:
            return shift
    return None


def _mean(poses: list[SE3]) -> SE3:
    """Mean of poses close to each other."""
    first = poses[0]
    turns = np.array([rotation_log(pose.rotation @ first.rotation.T) for pose in poses])
    middle = np.median(turns, axis=0)
    shift = np.median([pose.translation for pose in poses], axis=0)
    return SE3(SE3.from_rotvec(middle, np.zeros(3)).rotation @ first.rotation, shift)
