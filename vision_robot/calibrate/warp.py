"""The board as it really is: nearly flat.

A printed board bows and its paper stretches by about a tenth of a millimetre, which moves
the principal point more than all corner noise does. The departure from the drawing is a
smooth field over the board: polynomials out of the plane and in it, made orthonormal over
the board's points and free of what a pose or the choice of scale already explains.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float

__all__ = ["Warp"]

HIGHEST_DEGREE = 6


@dataclass(frozen=True)
class Warp:
    """Displacement of board point i: ``sum_k coefficients[k] basis[k, :, i]``.

    `basis` (m, 3, n) has unit mean square over the points, so a coefficient is the root
    mean square displacement [m] that it causes.
    """

    basis: Float[Array, "m 3 n"]
    coefficients: Float[Array, "m"]
    names: tuple[str, ...] = ()

    @classmethod
    def none(cls, points: int) -> "Warp":
        """The board exactly as drawn."""
        return cls(np.zeros((0, 3, points)), np.zeros(0))

    @classmethod
    def smooth(cls, board_points: Float[Array, "n 3"], degree: int) -> "Warp":
        """Polynomials in the board's plane up to `degree`, out of the plane and in it.

        Raises BadParameter for a degree that the points cannot carry.
        """
        if not 0 <= degree <= HIGHEST_DEGREE:
            raise BadParameter("degree of the board's warp", degree, f"between 0 and {HIGHEST_DEGREE}")
        n = len(board_points)
        if degree == 0:
            return cls.none(n)
        monomials, labels = _monomials(board_points[:, :2], degree)
        fields = np.zeros((len(labels), 3, n, 3))
        for axis in range(3):
            fields[:, axis, :, axis] = monomials
        # Out of the plane first: it matters most, and its names then stay the same.
        order = [(axis, k) for axis in (2, 0, 1) for k in range(len(labels))]
        candidates = np.stack([fields[k, axis].T.ravel() for axis, k in order])
        kept, names = [], []
        known = list(_rigid_and_scale(board_points))
        for (axis, k), field in zip(order, candidates, strict=True):
            rest = field / np.linalg.norm(field)
            for _ in range(2):
                for other in known:
                    rest = rest - (rest @ other) * other
            size = np.linalg.norm(rest)
            if size < 1e-6:
                continue
            known.append(rest / size)
            kept.append(rest / size * np.sqrt(n))
            names.append(f"board {'xyz'[axis]}({labels[k]})")
        if len(kept) > 2 * n:
            raise BadParameter("degree of the board's warp", degree, f"lower for a board of {n} points")
        return cls(np.array(kept).reshape(-1, 3, n), np.zeros(len(kept)), tuple(names))

    @property
    def displacement(self) -> Float[Array, "n 3"]:
        """Displacement of every board point [m]."""
        return np.einsum("k,kin->ni", self.coefficients, self.basis)

    def __len__(self) -> int:
        return len(self.coefficients)


def _monomials(xy: Float[Array, "n 2"], degree: int) -> tuple[Array, list[str]]:
    centred = xy - xy.mean(axis=0)
    x, y = (centred / np.abs(centred).max()).T
    powers = [(total - j, j) for total in range(degree + 1) for j in range(total + 1)]
    labels = [_power("x", i) + _power("y", j) or "1" for i, j in powers]
    return np.stack([x**i * y**j for i, j in powers]), labels


def _power(name: str, exponent: int) -> str:
    return "" if exponent == 0 else name if exponent == 1 else f"{name}^{exponent}"


def _rigid_and_scale(points: Float[Array, "n 3"]) -> Float[Array, "7 3*n"]:
    """Orthonormal fields that poses (three turns, three shifts) and the board's unit already hold."""
    centred = points - points.mean(axis=0)
    shifts = [np.tile(axis, (len(points), 1)) for axis in np.eye(3)]
    turns = [np.cross(axis, centred) for axis in np.eye(3)]
    fields = np.stack([field.T.ravel() for field in (*shifts, *turns, centred)])
    return np.linalg.qr(fields.T)[0].T
