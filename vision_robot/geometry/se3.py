"""Rigid transforms in three dimensions."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["SE3", "rotation_exp", "rotation_log", "skew"]

_SMALL = 1e-8


def skew(vector: Float[Array, "*batch 3"]) -> Float[Array, "*batch 3 3"]:
    """Matrix of the cross product: ``skew(a) @ b == cross(a, b)``."""
    x, y, z = np.moveaxis(np.asarray(vector, dtype=float), -1, 0)
    o = np.zeros_like(x)
    return np.stack([o, -z, y, z, o, -x, -y, x, o], axis=-1).reshape(*x.shape, 3, 3)


def _angle_factors(angle: Float[Array, "*batch"]) -> tuple[Array, Array, Array]:
    """sin(a)/a, (1 - cos a)/a^2 and (a - sin a)/a^3, with their Taylor series near zero."""
    small = angle < 1e-4
    a = np.where(small, 1.0, angle)
    a2 = angle * angle
    first = np.where(small, 1 - a2 / 6, np.sin(a) / a)
    # 2 sin^2(a/2)/a^2 keeps all digits where 1 - cos a would lose half of them.
    second = np.where(small, 0.5 - a2 / 24, 2 * np.sin(a / 2) ** 2 / (a * a))
    third = np.where(small, 1 / 6 - a2 / 120, (a - np.sin(a)) / a**3)
    return first, second, third


def rotation_exp(rotvec: Float[Array, "*batch 3"]) -> Float[Array, "*batch 3 3"]:
    """Rotation matrix of a rotation vector [rad] (Rodrigues' formula)."""
    rotvec = np.asarray(rotvec, dtype=float)
    first, second, _ = _angle_factors(np.linalg.norm(rotvec, axis=-1))
    K = skew(rotvec)
    return np.eye(3) + first[..., None, None] * K + second[..., None, None] * (K @ K)


def rotation_log(rotation: Float[Array, "*batch 3 3"]) -> Float[Array, "*batch 3"]:
    """Rotation vector [rad], length in [0, pi], of a rotation matrix.

    Goes through the unit quaternion of largest component (Shepperd 1978), which keeps
    full precision at every angle, half turns included.
    """
    R = np.asarray(rotation, dtype=float)
    m00, m11, m22 = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    # Four times the outer product q q^T of the quaternion (w, x, y, z) with itself.
    w_xyz = [R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]]
    xy, xz, yz = R[..., 0, 1] + R[..., 1, 0], R[..., 0, 2] + R[..., 2, 0], R[..., 1, 2] + R[..., 2, 1]
    rows = [
        [1 + m00 + m11 + m22, *w_xyz],
        [w_xyz[0], 1 + m00 - m11 - m22, xy, xz],
        [w_xyz[1], xy, 1 - m00 + m11 - m22, yz],
        [w_xyz[2], xz, yz, 1 - m00 - m11 + m22],
    ]
    outer = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    best = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(outer, best[..., None, None], axis=-2)[..., 0, :]
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    q = np.where(q[..., :1] < 0, -q, q)
    sine = np.linalg.norm(q[..., 1:], axis=-1)
    angle = 2 * np.arctan2(sine, q[..., 0])
    small = sine < _SMALL
    scale = np.where(small, 2.0, angle / np.where(small, 1.0, sine))
    return scale[..., None] * q[..., 1:]


@dataclass(frozen=True)
class SE3:
    """A batch of rigid transforms.

    A variable is named for what it maps: ``cam_from_board = SE3(...)`` maps points in the
    board frame to points in the camera frame, ``cam_from_board.apply(points_in_board)``, and
    chains as ``cam_from_station @ station_from_board``. Lengths are metres.
    """

    rotation: Float[Array, "*batch 3 3"]
    translation: Float[Array, "*batch 3"]

    def __post_init__(self) -> None:
        rotation = np.asarray(self.rotation, dtype=float)
        translation = np.asarray(self.translation, dtype=float)
        batch = np.broadcast_shapes(rotation.shape[:-2], translation.shape[:-1])
        object.__setattr__(self, "rotation", np.broadcast_to(rotation, (*batch, 3, 3)))
        object.__setattr__(self, "translation", np.broadcast_to(translation, (*batch, 3)))

    @classmethod
    def identity(cls, *batch: int) -> Self:
        """The transform that moves nothing, in the given batch shape."""
        return cls(np.broadcast_to(np.eye(3), (*batch, 3, 3)), np.zeros((*batch, 3)))

    @classmethod
    def from_matrix(cls, matrix: Float[Array, "*batch 4 4"]) -> Self:
        """From homogeneous matrices."""
        matrix = np.asarray(matrix, dtype=float)
        return cls(matrix[..., :3, :3], matrix[..., :3, 3])

    @classmethod
    def from_rotvec(cls, rotvec: Float[Array, "*batch 3"], translation: Float[Array, "*batch 3"]) -> Self:
        """From a rotation vector [rad] and a translation [m], kept apart (not a twist)."""
        return cls(rotation_exp(rotvec), translation)

    @classmethod
    def exp(cls, twist: Float[Array, "*batch 6"]) -> Self:
        """Exponential of a twist (v [m], omega [rad]) (Lynch & Park 2017, eq. 3.88)."""
        twist = np.asarray(twist, dtype=float)
        v, omega = twist[..., :3], twist[..., 3:]
        return cls(rotation_exp(omega), (_left_jacobian(omega) @ v[..., None])[..., 0])

    def log(self) -> Float[Array, "*batch 6"]:
        """Twist (v, omega) with ``SE3.exp(twist) == self`` and ``|omega| <= pi``."""
        omega = rotation_log(self.rotation)
        v = np.linalg.solve(_left_jacobian(omega), self.translation[..., None])[..., 0]
        return np.concatenate([v, omega], axis=-1)

    @property
    def batch(self) -> tuple[int, ...]:
        """Shape of the batch; ``()`` for a single transform."""
        return self.translation.shape[:-1]

    def __len__(self) -> int:
        return len(self.translation) if self.batch else 0

    def __getitem__(self, index: object) -> "SE3":
        if not self.batch:
            raise IndexError("a single transform has no batch axis to index")
        return SE3(self.rotation[index], self.translation[index])  # pyright: ignore[reportArgumentType, reportCallIssue]

    def as_matrix(self) -> Float[Array, "*batch 4 4"]:
        """Homogeneous matrices."""
        matrix = np.zeros((*self.batch, 4, 4))
        matrix[..., :3, :3] = self.rotation
        matrix[..., :3, 3] = self.translation
        matrix[..., 3, 3] = 1
        return matrix

    def rotvec(self) -> Float[Array, "*batch 3"]:
        """Rotation vectors [rad]."""
        return rotation_log(self.rotation)

    def inverse(self) -> "SE3":
        """``board_from_cam`` of ``cam_from_board``."""
        transpose = np.swapaxes(self.rotation, -1, -2)
        return SE3(transpose, -(transpose @ self.translation[..., None])[..., 0])

    def adjoint(self) -> Float[Array, "*batch 6 6"]:
        """Maps twists: ``self @ exp(t) == exp(self.adjoint() @ t) @ self``."""
        result = np.zeros((*self.batch, 6, 6))
        result[..., :3, :3] = result[..., 3:, 3:] = self.rotation
        result[..., :3, 3:] = skew(self.translation) @ self.rotation
        return result

    def apply(self, points: Float[Array, "*sets n 3"]) -> Float[Array, "*each n 3"]:
        """Points (n, 3) of the right frame, in the left frame; one set of points for each transform."""
        points = np.asarray(points, dtype=float)
        return points @ np.swapaxes(self.rotation, -1, -2) + self.translation[..., None, :]

    def __matmul__(self, other: "SE3") -> "SE3":
        moved = (self.rotation @ other.translation[..., None])[..., 0]
        return SE3(self.rotation @ other.rotation, moved + self.translation)


def _left_jacobian(omega: Float[Array, "*batch 3"]) -> Float[Array, "*batch 3 3"]:
    """Left Jacobian of SO(3), which carries a twist's v to the translation (Sola 2018, eq. 145)."""
    _, second, third = _angle_factors(np.linalg.norm(omega, axis=-1))
    K = skew(omega)
    return np.eye(3) + second[..., None, None] * K + third[..., None, None] * (K @ K)
