"""What every lens model is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from vision_robot.types import Array, Bool, Float

__all__ = ["Lens", "first_positive_root"]

Coefficients = Sequence[float]

BLOCK = 8192
"""Points worked on at a time: their temporaries stay in the processor's cache."""
RIM = 64
"""Azimuths at which the first fold is looked for."""
TABLE = 4096
"""Entries of the radial table which starts the inversion."""


@dataclass(frozen=True)
class Lens:
    """A lens: the map from points in the camera frame to the ideal image plane.

    The ideal plane has focal length one and its origin on the optical axis; `Camera`
    scales it to pixels. A lens is described along the *field coordinate* s, the radius
    that the pinhole (s = tan theta) or the angle (s = theta) gives a ray at angle theta
    from the axis: `radial` is its radial part, and `fold` where that stops growing, past
    which two rays would share a pixel and the model means nothing.
    """

    name: str
    coefficient_names: tuple[str, ...]
    distort: Callable[[Array, Coefficients], Array]
    """(points (3, n), k) -> distorted (2, n)."""
    jacobian: Callable[[Array, Coefficients], tuple[Array, Array]]
    """(points (3, n), k) -> distorted (2, n), derivatives (2, 3 + n_k, n) in the point, then in k."""
    radial: Callable[[Array, Coefficients], tuple[Array, Array]]
    """(s, k) -> distorted radius and its derivative in s, tangential terms left out."""
    fold: Callable[[tuple[float, ...]], float]
    """k -> the largest s of the field of view."""
    field: Callable[[Array], Array]
    """points (3, n) -> field coordinate s (n,), infinite where the model sees nothing."""
    ray: Callable[[Array, Array], Array]
    """(s (n,), unit directions (2, n)) -> points (3, n) on the rays."""
    tangential: bool = False
    """Whether terms besides the radial ones need a second Newton iteration to undo."""

    def undistort(self, distorted: Float[Array, "2 n"], k: Coefficients) -> Float[Array, "3 n"]:
        """Rays (3, n), not normalised, through distorted points; NaN where no ray leads there."""
        rays = np.full((3, distorted.shape[1]), np.nan)
        radius = np.hypot(distorted[0], distorted[1])
        known = radius <= _reach(self, tuple(k))
        table = self._radial_table(radius[known].max(initial=0.0), min(TABLE, 16 + radius.size), k)
        for first in range(0, radius.size, BLOCK):
            part = slice(first, first + BLOCK)
            index = np.flatnonzero(known[part]) + first
            rays[:, index] = self._undistort(distorted[:, index], radius[index], table, k)
        return rays

    def sees(self, points: Float[Array, "3 n"], k: Coefficients) -> Bool[Array, "n"]:
        """Which points lie inside the field where the model is one to one."""
        inside = self._inside_fold(points, k)
        if self.tangential:
            for first in range(0, inside.size, BLOCK):
                index = np.flatnonzero(inside[first : first + BLOCK]) + first
                x, y, z = points[:, index]
                J = self.jacobian(np.stack([x / z, y / z, np.ones_like(z)]), k)[1]
                inside[index] = _upright(J)
        return inside

    def _inside_fold(self, points: Array, k: Coefficients) -> Array:
        """Whether points lie nearer to the axis than where the picture folds back."""
        with np.errstate(invalid="ignore"):
            s = self.field(points)
            inside = s <= self.fold(tuple(k))
            if self.tangential and np.isfinite(_sampled_rim(self, tuple(k))).any():
                inside &= s <= _rim(self, tuple(k), np.arctan2(points[1], points[0]))
        return inside

    def _undistort(
        self, distorted: Array, radius: Array, table: tuple[Array, Array], k: Coefficients
    ) -> Array:
        towards = np.where(radius > 0, distorted / np.where(radius > 0, radius, 1.0), 0.0)
        if self.tangential:
            s, reached = self._invert_radial(radius, table, k, tolerance=1e-3)
            start = np.where(reached, s, 0.98 * table[0][-1])  # past the radial reach: a little inside
            rays, found = self._polish(self.ray(start, towards), distorted, k)
        else:
            s, found = self._invert_radial(radius, table, k, tolerance=4e-16)
            rays = self.ray(s, towards)
        return np.where(found, rays, np.nan)

    def _radial_table(self, farthest: float, count: int, k: Coefficients) -> tuple[Array, Array]:
        """Field coordinates from 0 to past the one imaged at `farthest`, and their radii."""
        low, high = 0.0, self.fold(tuple(k))
        # Only its part in use is worth a table: halve the field down to it.
        for _ in range(60):
            middle = (low + high) / 2
            if self.radial(np.array([middle]), k)[0][0] < farthest:
                break
            high = middle
        s = np.linspace(0.0, high, count)
        return s, np.maximum.accumulate(self.radial(s, k)[0])

    def _invert_radial(
        self, radius: Array, table: tuple[Array, Array], k: Coefficients, *, tolerance: float
    ) -> tuple[Array, Array]:
        """Solve radial(s) = radius by Newton kept inside the table's bracket, which shrinks.

        Ends with the step below `tolerance` of s, and tells which radii the lens reaches.
        """
        grid, values = table
        found = radius <= values[-1] * (1 + 1e-12)
        target = np.minimum(radius, values[-1])
        cell = np.clip(np.searchsorted(values, target, side="right"), 1, len(grid) - 1)
        low, high = grid[cell - 1], grid[cell]
        s = np.interp(target, values, grid)
        active = np.flatnonzero(found)
        for _ in range(80):
            at = s[active]
            value, slope = self.radial(at, k)
            error = value - target[active]
            below, above = np.where(error <= 0, at, low[active]), np.where(error >= 0, at, high[active])
            low[active], high[active] = below, above
            with np.errstate(divide="ignore", invalid="ignore"):
                step = at - error / slope
            step = np.where((step >= below) & (step <= above), step, (below + above) / 2)
            s[active] = step
            active = active[np.abs(step - at) > tolerance * at]
            if not active.size:
                break
        return s, found

    def _polish(self, rays: Array, distorted: Array, k: Coefficients) -> tuple[Array, Array]:
        """Newton in the plane z = 1, which brings in the tangential terms."""
        plane = rays[:2] / rays[2]
        found = np.zeros(plane.shape[1], dtype=bool)
        active = np.arange(plane.shape[1])
        for _ in range(40):
            at = plane[:, active]
            value, J = self.jacobian(np.stack([*at, np.ones(active.size)]), k)
            eu, ev = value - distorted[:, active]
            det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                step = np.stack([J[1, 1] * eu - J[0, 1] * ev, J[0, 0] * ev - J[1, 0] * eu]) / det
                length, scale = np.hypot(*step), 1 + np.hypot(*at)
                plane[:, active] = at - step * np.minimum(1.0, 0.2 * scale / np.maximum(length, 1e-300))
            # The residual after a step is second order in its length: 1e-16 after one of 1e-8.
            done = length < 1e-8 * scale
            found[active] = done & _upright(J)
            active = active[~done & np.isfinite(length)]
            if not active.size:
                break
        rays = np.stack([*plane, np.ones(plane.shape[1])])
        return rays, found & self._inside_fold(rays, k)


def _upright(J: Array) -> Array:
    """Whether the picture is neither folded (det < 0) nor folded twice (then the trace is negative)."""
    return (J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0] > 0) & (J[0, 0] + J[1, 1] > 0)


def _rim(lens: Lens, k: tuple[float, ...], azimuth: Array) -> Array:
    """A field coordinate at or a little past the first fold met from the axis along each azimuth.

    Where tangential terms fold the picture in some directions only, it may unfold again
    farther out, and there the Jacobian looks healthy although pixels are taken twice.
    """
    rim = _sampled_rim(lens, k)
    place = (azimuth / (2 * np.pi)) % 1 * RIM
    cell = np.minimum(np.nan_to_num(place).astype(int), RIM - 1)
    a, b, share = rim[cell], rim[cell + 1], place - cell
    return np.where(np.isinf(a) | np.isinf(b), np.minimum(a, b), (1 - share) * a + share * b)


@lru_cache(maxsize=64)
def _sampled_rim(lens: Lens, k: tuple[float, ...]) -> Array:
    angle = np.linspace(0, np.arctan(lens.fold(k)), 4 * RIM)
    azimuth = np.linspace(0, 2 * np.pi, RIM + 1)
    s = np.append(np.tan(angle), np.inf)
    x, y = (np.outer(f(azimuth), s[:-1]).ravel() for f in (np.cos, np.sin))
    good = _upright(lens.jacobian(np.stack([x, y, np.ones_like(x)]), k)[1]).reshape(RIM + 1, -1)
    # The last sample lies on the radial fold itself, which has its own exact test.
    bad = ~good[:, :-1]
    first = np.where(bad.any(axis=1), bad.argmax(axis=1) + 1, len(angle))
    return s[first]


@lru_cache(maxsize=256)
def _reach(lens: Lens, k: tuple[float, ...]) -> float:
    """A bound of the distorted radius over the field: farther out there is nothing to look for."""
    top = lens.fold(k)
    if not lens.tangential:
        return float(lens.radial(np.array([top]), k)[0][0]) * (1 + 1e-12)
    s, angle = np.meshgrid(np.linspace(0, top, 33)[1:], np.linspace(0, 2 * np.pi, 64, endpoint=False))
    rays = lens.ray(s.ravel(), np.stack([np.cos(angle.ravel()), np.sin(angle.ravel())]))
    return 1.02 * float(np.hypot(*lens.distort(rays, k)).max())


def first_positive_root(polynomial: Sequence[float], otherwise: float) -> float:
    """Smallest positive real root of a polynomial given from the constant term up, at most `otherwise`."""
    # In units of `otherwise`, where a coefficient below rounding cannot move a root of [0, 1].
    scaled = np.asarray(polynomial, dtype=float) * otherwise ** np.arange(len(polynomial))
    trimmed = np.polynomial.Polynomial(scaled).trim(1e-16 * abs(scaled[0]))
    roots = np.asarray(trimmed.roots(), dtype=complex) * otherwise
    real = roots.real[(np.abs(roots.imag) < 1e-9 * np.abs(roots)) & (roots.real > 0)]
    return float(min(real.min(initial=otherwise), otherwise))
