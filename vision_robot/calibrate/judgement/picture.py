"""How a change of the intrinsics shows over the whole picture, in pixels and on a plane.

A camera is judged by where it sees the directions of a regular grid of pixels, after the
rotation that suits it best: a turn of the camera's frame is taken up by whatever places
the camera afterwards (mrcal's implied transformation, see `projection_uncertainty`).
"""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.judgement.projection_uncertainty import picture_grid
from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera, skew
from vision_robot.types import Array, Bool, Float

__all__ = ["Picture"]

GRID = (32, 24)
STEEPEST = np.radians(70)
"""Rays farther from the axis meet no plane that faces the camera where a person would put one."""


@dataclass(frozen=True)
class Picture:
    """Directions spread over a camera's picture, and how they move with its intrinsics.

    `pixels` (n, 2) of the grid that have a ray, `rays` (n, 3); `gain` (n, 2, p) carries a
    small change of Camera.parameters to pixels, the best rotation taken out; `on_plane`
    (n, 2, 2) carries pixels to positions [m] on the plane z = 1 m, NaN for rays steeper
    than 70 degrees.
    """

    camera: Camera
    pixels: Float[Array, "n 2"]
    rays: Float[Array, "n 3"]
    gain: Float[Array, "n 2 p"]
    on_plane: Float[Array, "n 2 2"]

    @classmethod
    def of(cls, camera: Camera) -> "Picture":
        """Over the grid of the camera's picture."""
        pixels = picture_grid(camera, *GRID).reshape(-1, 2)
        rays = camera.unproject(pixels)
        known = np.isfinite(rays).all(axis=1)
        if known.sum() < 3:
            raise BadParameter("camera", camera.parameters.tolist(), "one with rays over its picture")
        pixels, rays = pixels[known], rays[known]
        gain, turn, on_plane = _jacobians(camera, rays)
        sound = np.isfinite(gain).all(axis=(1, 2))
        pixels, rays, gain, turn, on_plane = (a[sound] for a in (pixels, rays, gain, turn, on_plane))
        return cls(camera, pixels, rays, _without_turn(gain, turn), on_plane)

    def turned_on(self, part: Bool[Array, "n"]) -> "Picture":
        """The same with the rotation that suits a part of the picture best."""
        _, turn, _ = _jacobians(self.camera, self.rays)
        return replace(self, gain=_without_turn(self.gain, turn, part))

    def where(self, keep: Bool[Array, "n"]) -> "Picture":
        """A part of the picture, with the rotation that suits this part best."""
        gain = self.turned_on(keep).gain
        return Picture(self.camera, self.pixels[keep], self.rays[keep], gain[keep], self.on_plane[keep])

    def variance(self, covariance: Float[Array, "p p"]) -> Float[Array, "n"]:
        """Mean square length of each pixel's error [px^2] under the covariance of the intrinsics."""
        return np.einsum("nip,pq,niq->n", self.gain, covariance, self.gain)

    def weight(self, distance_m: float | None = None) -> Float[Array, "p p"]:
        """M with ``tr(M C)`` the mean square error over the picture [px^2] under the covariance C.

        With `distance_m`, that of positions on the plane z = `distance_m` that faces the camera [m^2].
        """
        gain = self.gain
        if distance_m is not None:
            near = np.isfinite(self.on_plane).all(axis=(1, 2))
            gain = distance_m * self.on_plane[near] @ gain[near]
        return np.einsum("nip,niq->pq", gain, gain) / len(gain)

    def difference(self, other: Camera) -> Float[Array, "n 2"]:
        """Where `other` sees the rays less where this camera does [px], the best rotation taken out.

        NaN where `other` does not see.
        """
        moved = other.project(self.rays) - self.pixels
        _, turn, _ = _jacobians(self.camera, self.rays)
        return _without_turn(moved[..., None], turn)[..., 0]

    def mean_square(self, moved: Float[Array, "n 2"], distance_m: float | None = None) -> float:
        """Mean square length of displacements [px^2], or with `distance_m` on that plane [m^2]."""
        if distance_m is not None:
            moved = distance_m * (self.on_plane @ moved[..., None])[..., 0]
        known = np.isfinite(moved).all(axis=1)
        return float(np.mean(np.sum(moved[known] ** 2, axis=1))) if known.any() else np.nan


def _jacobians(camera: Camera, rays: Float[Array, "n 3"]) -> tuple[Array, Array, Array]:
    """The pixels' derivatives in the parameters (n, 2, p) and a turn (n, 2, 3); on_plane (n, 2, 2)."""
    _, in_point, in_parameters = camera.project_jacobian(rays)
    with np.errstate(divide="ignore", invalid="ignore"):
        # On z = 1 the point is the ray over its z: the pixel's derivative there is 2x2 and invertible.
        per_plane = in_point[..., :2] * rays[:, 2, None, None]
        usable = (rays[:, 2] > np.cos(STEEPEST)) & np.isfinite(per_plane).all(axis=(1, 2))
    on_plane = np.full(per_plane.shape, np.nan)
    on_plane[usable] = np.linalg.inv(per_plane[usable])
    return in_parameters, -in_point @ skew(rays), on_plane


def _without_turn(
    moved: Float[Array, "n 2 k"], turn: Float[Array, "n 2 3"], part: Bool[Array, "n"] | None = None
) -> Float[Array, "n 2 k"]:
    """Displacements less the rotation that explains them, or a part of them, best."""
    known = np.isfinite(moved).all(axis=(1, 2)) & np.isfinite(turn).all(axis=(1, 2))
    known = known if part is None else known & part
    P, J = turn[known].reshape(-1, 3), moved[known].reshape(-1, moved.shape[-1])
    return moved - turn @ np.linalg.lstsq(P, J, rcond=None)[0]
