"""Where the search for a tool's tip starts: linear equations in rays, then the nearest rotation.

For a ray b seen at pose i, ``b x (R_c (R_i p + t_i) + t_c) = 0``. With R_c and t_c unknown the products
R_c R_i p spoil linearity, so p is found by a scan: for each candidate the rest is a camera's pose from
points known in the base, which is solved directly.
"""

from collections.abc import Sequence

import numpy as np

from vision_robot.errors import NoConvergence
from vision_robot.extrinsics.tip_view import TipView
from vision_robot.geometry import SE3, Camera
from vision_robot.types import Array, Bool, Float

__all__ = ["pose_from_points", "start"]

LONGEST_M = 0.6
"""A tool longer than this is started from its own length anyway: the descent goes on from there."""


def start(
    base_from_wrist: SE3, views: Sequence[TipView], seen: Bool[Array, "c p"]
) -> tuple[Float[Array, "3"], list[SE3]]:
    """A tip and the cameras' places good enough to descend from; raises NoConvergence where there is none."""
    known = [view.cam_from_base for view in views]
    if all(pose is not None for pose in known):
        poses = [pose for pose in known if pose is not None]
        return _linear_tip(base_from_wrist, views, poses, seen), poses
    best, found = np.inf, None
    for tip in _candidates():
        points = base_from_wrist.apply(tip[None])[:, 0]
        poses, total = [], 0.0
        for view, one, pose in zip(views, seen, known, strict=True):
            place = pose
            if place is None:
                place = pose_from_points(view.known.camera, points[one], view.pixels[one])
            if place is None:
                total = np.inf
                break
            total += _error(view, place, points[one], view.pixels[one])
            poses.append(place)
        if total < best:
            best, found = total, (tip, poses)
    if found is None:
        raise NoConvergence("no camera place explains where the tip was seen")
    return found


def _candidates() -> Array:
    """Tips on spheres about the wrist, and at it."""
    directions = np.array([[0, 0, 1.0], [0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    lengths = np.array([0.08, 0.2, LONGEST_M / 1.5])
    return np.concatenate([np.zeros((1, 3)), (lengths[:, None, None] * directions).reshape(-1, 3)])


def _error(view: TipView, pose: SE3, points: Array, pixels: Array) -> float:
    """Angle between rays seen and foretold, which is a number whatever the pose."""
    rays = view.known.camera.unproject(pixels)
    aim = pose.apply(points)
    cosine = np.sum(rays * aim, axis=1) / np.linalg.norm(aim, axis=1)
    return float(np.nansum(1 - cosine))


def _linear_tip(
    base_from_wrist: SE3, views: Sequence[TipView], poses: list[SE3], seen: Bool[Array, "c p"]
) -> Float[Array, "3"]:
    """The point nearest to all rays, in the wrist's frame."""
    normal, rhs = np.zeros((3, 3)), np.zeros(3)
    for view, pose, one in zip(views, poses, seen, strict=True):
        rays = view.known.camera.unproject(view.pixels[one])
        good = np.isfinite(rays[:, 0])
        turned = pose.rotation @ base_from_wrist.rotation[one][good]
        shift = base_from_wrist.translation[one][good] @ pose.rotation.T + pose.translation
        across = np.eye(3) - rays[good, :, None] * rays[good, None, :]
        A = across @ turned
        normal += np.sum(A.transpose(0, 2, 1) @ A, axis=0)
        rhs -= np.einsum("nji,nj->i", A, np.einsum("nij,nj->ni", across, shift))
    return np.linalg.lstsq(normal, rhs, rcond=1e-9)[0]


def pose_from_points(camera: Camera, points: Float[Array, "n 3"], pixels: Float[Array, "n 2"]) -> SE3 | None:
    """A camera's pose from points known in space: rays, linear equations, the nearest rotation.

    Points on a plane leave three of the twelve numbers free: they are taken in its own axes.
    """
    rays = camera.unproject(pixels)
    good = np.isfinite(rays[:, 0])
    points, rays = points[good], rays[good]
    middle = points.mean(axis=0)
    _, size, axes = np.linalg.svd(points - middle, full_matrices=True)
    size = np.pad(size, (0, 3 - len(size)))
    axes[2] *= np.linalg.det(axes)
    if len(points) < 4 or size[1] < 1e-6 * size[0]:
        return None
    flat = size[2] < 0.02 * size[0] or len(points) < 6
    unit = size[0] / np.sqrt(len(points))
    local = (points - middle) @ axes.T / unit
    X = np.concatenate([local[:, : 2 if flat else 3], np.ones((len(points), 1))], axis=1)
    columns = X.shape[1]
    x, y, z = (rays[:, i, None] * X for i in range(3))
    none = np.zeros_like(x)
    A = np.concatenate(
        [
            np.concatenate([none, -z, y], axis=1),
            np.concatenate([z, none, -x], axis=1),
            np.concatenate([-y, x, none], axis=1),
        ]
    )
    M = np.linalg.svd(A)[2][-1].reshape(3, columns)
    if np.sum(rays * (X @ M.T)) < 0:
        M = -M
    if flat:
        scale = float(np.mean(np.linalg.norm(M[:, :2], axis=0)))
        R = np.column_stack([M[:, 0], M[:, 1], np.cross(M[:, 0], M[:, 1]) / max(scale, 1e-300)])
    else:
        R = M[:, :3]
        scale = float(np.cbrt(abs(np.linalg.det(R))))
    if scale <= 0:
        return None
    U, _, Vt = np.linalg.svd(R)
    rotation = U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt @ axes
    return SE3(rotation, M[:, -1] / scale * unit - rotation @ middle)
