"""The camera: a lens and an affine image plane."""

from dataclasses import dataclass, replace

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry.lens import Lens, lens_named
from vision_robot.types import Array, Bool, Float

__all__ = ["Camera"]

AFFINE_NAMES = ("fx", "fy", "cx", "cy", "skew")


@dataclass(frozen=True)
class Camera:
    """Intrinsics of one camera at one resolution.

    ``u = fx x + skew y + cx``, ``v = fy y + cy``, where (x, y) is what the lens `model`
    makes of a point in the camera frame (x right, y down, z forward). Pixels: u right,
    v down, (0, 0) the centre of the first pixel. fx, fy, cx, cy and skew are in pixels,
    `distortion` has no unit; its order is that of the lens' `coefficient_names`.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    skew: float = 0.0
    model: str = "pinhole"
    distortion: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        lens = lens_named(self.model)
        for name in ("width", "height"):
            value = getattr(self, name)
            if int(value) != value or value <= 0:
                raise BadParameter(f"camera {name}", value, "a positive whole number of pixels")
            object.__setattr__(self, name, int(value))
        for name in AFFINE_NAMES:
            object.__setattr__(self, name, float(getattr(self, name)))
        object.__setattr__(self, "distortion", tuple(float(k) for k in self.distortion))
        if not self.distortion:
            object.__setattr__(self, "distortion", (0.0,) * len(lens.coefficient_names))
        if len(self.distortion) != len(lens.coefficient_names):
            names = ", ".join(lens.coefficient_names) or "no coefficients"
            raise BadParameter(f"distortion of {self.model}", self.distortion, names)
        if not np.all(np.isfinite(self.parameters)):
            raise BadParameter("camera", self.parameters.tolist(), "finite numbers")
        if self.fx <= 0 or self.fy <= 0:
            raise BadParameter("focal length", (self.fx, self.fy), "positive")

    @property
    def lens(self) -> Lens:
        """The lens model."""
        return lens_named(self.model)

    @property
    def K(self) -> Float[Array, "3 3"]:
        """Camera matrix."""
        return np.array([[self.fx, self.skew, self.cx], [0, self.fy, self.cy], [0, 0, 1]])

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of `parameters`: fx, fy, cx, cy, skew and the lens' coefficients."""
        return (*AFFINE_NAMES, *self.lens.coefficient_names)

    @property
    def parameters(self) -> Float[Array, "p"]:
        """All intrinsics as a vector, in the order of `parameter_names`."""
        return np.array([self.fx, self.fy, self.cx, self.cy, self.skew, *self.distortion])

    def with_parameters(self, parameters: Float[Array, "p"]) -> "Camera":
        """The same kind of camera with other intrinsics."""
        affine, k = parameters[:5], parameters[5:]
        return replace(
            self,
            **{name: float(value) for name, value in zip(AFFINE_NAMES, affine, strict=True)},
            distortion=tuple(map(float, k)),
        )

    def project(self, points_in_cam: Float[Array, "*batch 3"]) -> Float[Array, "*batch 2"]:
        """Pixels of points; NaN where the point lies outside the lens' valid field of view."""
        points = np.asarray(points_in_cam, dtype=float)
        flat = points.reshape(-1, 3).T
        pixels = np.full((2, flat.shape[1]), np.nan)
        seen = self.lens.sees(flat, self.distortion)
        pixels[:, seen] = self._to_pixels(self.lens.distort(flat[:, seen], self.distortion))
        return pixels.T.reshape(*points.shape[:-1], 2)

    def project_jacobian(
        self, points_in_cam: Float[Array, "n 3"]
    ) -> tuple[Float[Array, "n 2"], Float[Array, "n 2 3"], Float[Array, "n 2 p"]]:
        """Pixels and their derivatives in the point [px/m] and in `parameters`.

        Rows outside the valid field are NaN, as in `project`.
        """
        points = np.asarray(points_in_cam, dtype=float)
        seen = self.lens.sees(points.T, self.distortion)
        n, n_k = len(points), len(self.distortion)
        pixels, in_point = np.full((n, 2), np.nan), np.full((n, 2, 3), np.nan)
        in_parameters = np.full((n, 2, 5 + n_k), np.nan)
        distorted, J = self.lens.jacobian(points[seen].T, self.distortion)
        pixels[seen] = self._to_pixels(distorted).T
        # A = [[fx, skew], [0, fy]] carries the ideal plane to pixels.
        J_px = np.einsum("ij,jcn->nic", self.K[:2, :2], J)
        in_point[seen] = J_px[..., :3]
        x, y = distorted
        o, one = np.zeros_like(x), np.ones_like(x)
        affine = np.array([[x, o, one, o, y], [o, y, o, one, o]])
        in_parameters[seen, :, :5] = affine.transpose(2, 0, 1)
        in_parameters[seen, :, 5:] = J_px[..., 3:]
        return pixels, in_point, in_parameters

    def unproject(self, pixels: Float[Array, "*batch 2"]) -> Float[Array, "*batch 3"]:
        """Unit rays in the camera frame through pixels; NaN where no ray leads there."""
        pixels = np.asarray(pixels, dtype=float)
        with np.errstate(invalid="ignore", over="ignore"):  # pixels that are no numbers have no ray
            flat = self._from_pixels(pixels.reshape(-1, 2).T)
            rays = self.lens.undistort(flat, self.distortion)
        return (rays / np.linalg.norm(rays, axis=0)).T.reshape(*pixels.shape[:-1], 3)

    def undistorted_pixels(self, pixels: Float[Array, "*batch 2"]) -> Float[Array, "*batch 2"]:
        """Where the pixels would lie without lens distortion, under the same K."""
        rays = self.unproject(pixels)
        with np.errstate(invalid="ignore", divide="ignore"):
            plane = np.where(rays[..., 2:] > 0, rays[..., :2] / rays[..., 2:], np.nan)
        flat = self._to_pixels(plane.reshape(-1, 2).T)
        return flat.T.reshape(*plane.shape)

    def sees(self, points_in_cam: Float[Array, "*batch 3"]) -> Bool[Array, "*batch"]:
        """Which points are imaged: inside the lens' valid field and inside the picture."""
        pixels = self.project(points_in_cam)
        with np.errstate(invalid="ignore"):
            u, v = pixels[..., 0], pixels[..., 1]
            return (u >= -0.5) & (u <= self.width - 0.5) & (v >= -0.5) & (v <= self.height - 0.5)

    def without_distortion(self) -> "Camera":
        """The pinhole camera with the same K."""
        return replace(self, model="pinhole", distortion=())

    def _to_pixels(self, distorted: Float[Array, "2 n"]) -> Float[Array, "2 n"]:
        x, y = distorted
        return np.stack([self.fx * x + self.skew * y + self.cx, self.fy * y + self.cy])

    def _from_pixels(self, pixels: Float[Array, "2 n"]) -> Float[Array, "2 n"]:
        y = (pixels[1] - self.cy) / self.fy
        return np.stack([(pixels[0] - self.cx - self.skew * y) / self.fx, y])


def pixel_grid(width: int, height: int) -> Float[Array, "height width 2"]:
    """Centres (u, v) of all pixels of a picture."""
    u, v = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    return np.stack([u, v], axis=-1)
