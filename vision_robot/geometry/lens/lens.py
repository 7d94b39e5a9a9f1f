"""What every lens model is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.types import Array, Bool, Float

__all__ = ["Lens", "first_positive_root"]

Coefficients = Sequence[float]


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
    fold: Callable[[Coefficients], float]
    """k -> the largest s of the field of view."""
    field: Callable[[Array], Array]
    """points (3, n) -> field coordinate s (n,), infinite where the model sees nothing."""
    ray: Callable[[Array, Array], Array]
    """(s (n,), unit directions (2, n)) -> points (3, n) on the rays."""
    tangential: bool = False
    """Whether terms besides the radial ones need a second Newton iteration to undo."""

    def undistort(self, distorted: Float[Array, "2 n"], k: Coefficients) -> Float[Array, "3 n"]:
        """Rays (3, n), not normalised, through distorted points; NaN where no ray leads there."""
        radius = np.hypot(distorted[0], distorted[1])
        towards = np.where(radius > 0, distorted / np.where(radius > 0, radius, 1.0), 0.0)
        s, found = self._invert_radial(radius, k)
        rays = self.ray(s, towards)
        if self.tangential:
            rays, found = self._polish(rays, distorted, k)
            found &= self.field(rays) <= self.fold(k)
        return np.where(found, rays, np.nan)

    def sees(self, points: Float[Array, "3 n"], k: Coefficients) -> Bool[Array, "n"]:
        """Which points lie inside the field where the model is one to one."""
        with np.errstate(invalid="ignore"):
            inside = self.field(points) <= self.fold(k)
        if self.tangential and inside.any():
            inside[inside] = self._determinant(points[:, inside], k) > 0
        return inside

    def _invert_radial(self, radius: Array, k: Coefficients) -> tuple[Array, Array]:
        """Solve radial(s) = radius by Newton kept inside a shrinking bracket."""
        top = self.fold(k)
        reach = self.radial(np.array([top]), k)[0][0]
        # A tangential lens may reach a little past its radial part; its polish decides.
        found = np.isfinite(radius) & (radius <= reach * (1.02 if self.tangential else 1 + 1e-12))
        target = np.where(found, np.minimum(radius, reach), 0.0)
        low, high = np.zeros_like(target), np.full_like(target, top)
        s = np.minimum(target, top)
        for _ in range(80):
            value, slope = self.radial(s, k)
            error = value - target
            low, high = np.where(error <= 0, s, low), np.where(error >= 0, s, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = s - error / slope
            step = np.where((step > low) & (step < high), step, (low + high) / 2)
            done = np.abs(step - s) <= 4e-16 * np.maximum(s, 1e-300)
            s = np.where(error == 0, s, step)
            if np.all(done | (error == 0)):
                break
        return s, found

    def _polish(self, rays: Array, distorted: Array, k: Coefficients) -> tuple[Array, Array]:
        """Newton in the plane z = 1, which brings in the tangential terms."""
        x, y = rays[0] / rays[2], rays[1] / rays[2]
        one = np.ones_like(x)
        for _ in range(20):
            value, J = self.jacobian(np.stack([x, y, one]), k)
            eu, ev = value - distorted
            det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
            with np.errstate(divide="ignore", invalid="ignore"):
                dx = (J[1, 1] * eu - J[0, 1] * ev) / det
                dy = (J[0, 0] * ev - J[1, 0] * eu) / det
            length = np.hypot(dx, dy)
            cap = np.minimum(1.0, 0.2 * (1 + np.hypot(x, y)) / np.maximum(length, 1e-300))
            x, y = x - cap * dx, y - cap * dy
            if not np.any(length > 1e-15 * (1 + np.hypot(x, y))):
                break
        rays = np.stack([x, y, one])
        value, J = self.jacobian(rays, k)
        error = np.hypot(*(value - distorted))
        det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
        with np.errstate(invalid="ignore"):
            return rays, (error <= 1e-12 * (1 + np.hypot(x, y))) & (det > 0)

    def _determinant(self, points: Array, k: Coefficients) -> Array:
        on_plane = np.stack([points[0] / points[2], points[1] / points[2], np.ones(points.shape[1])])
        J = self.jacobian(on_plane, k)[1]
        return J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]


def first_positive_root(polynomial: Sequence[float], otherwise: float) -> float:
    """Smallest positive real root of a polynomial given from the constant term up."""
    roots = np.polynomial.Polynomial(polynomial).trim().roots()
    real = roots.real[(np.abs(roots.imag) < 1e-9 * np.maximum(1, np.abs(roots))) & (roots.real > 0)]
    return float(min(real.min(initial=otherwise), otherwise))
