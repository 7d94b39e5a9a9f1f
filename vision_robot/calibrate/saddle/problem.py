"""Pictures of many corners as functions of their parameters."""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.grid_shape import GridShape
from vision_robot.calibrate.saddle.model import blurred_saddle
from vision_robot.calibrate.saddle.window import Windows
from vision_robot.types import Array, Float

__all__ = ["GEOMETRY", "SaddleProblem"]

GEOMETRY = 6
"""Parameters ahead of those of the light."""

MOST_CORRELATION = 0.95

Theta = Float[Array, "n p"]
Field = Float[Array, "n m"]


@dataclass(frozen=True)
class SaddleProblem:
    """Weighted samples of n corners in windows of m pixels, and what predicts them.

    The parameters theta of a corner: its offset from the start (2) [px]; the normals of its two edges, each
    over the blur across it (2 + 2) [1/px]; mean level (1, or 3 with its slopes); half
    contrast (1, or 3 with its slopes). Slopes are per root-mean-square `radius` of the window.

    `light` (n, 1 or 3, m): root weights times 1, u/radius, v/radius. `sag` (2, n, m): how far each edge
    bends away from straight at each pixel [px].
    """

    u: Field
    v: Field
    target: Field
    light: Float[Array, "n k m"]
    sag: Float[Array, "2 n m"]
    correlation: Float[Array, "n"]
    radius: Float[Array, "n"]

    @classmethod
    def of(cls, window: Windows, shape: GridShape, *, even_light: bool) -> "SaddleProblem":
        """The problem in these windows, for edges that lie like `shape`."""
        root, u, v = np.sqrt(window.weight), window.u, window.v
        square = (window.weight * (u * u + v * v)).sum(axis=1) / window.weight.sum(axis=1).clip(1e-6)
        radius = np.sqrt(square).clip(1)
        slopes = [] if even_light else [root * u / radius[:, None], root * v / radius[:, None]]
        along = shape.edges / np.linalg.norm(shape.edges, axis=2, keepdims=True)
        t, bend = along.astype(np.float32), (shape.curvature / 2).astype(np.float32)
        sag = [bend[:, e, None] * (t[:, e, :1] * u + t[:, e, 1:] * v) ** 2 for e in range(2)]
        cosine = (along[:, 0] * along[:, 1]).sum(axis=1)
        return cls(
            u,
            v,
            root * window.sample,
            np.stack([root, *slopes], axis=1),
            np.stack(sag),
            np.clip(cosine, -MOST_CORRELATION, MOST_CORRELATION),
            radius.astype(float),
        )

    @property
    def weight(self) -> Field:
        """Weights of the squared residuals."""
        return self.light[:, 0] ** 2

    def take(self, some: Array) -> "SaddleProblem":
        """The problem of some of the corners."""
        return SaddleProblem(
            self.u[some],
            self.v[some],
            self.target[some],
            self.light[some],
            self.sag[:, some],
            self.correlation[some],
            self.radius[some],
        )

    def linearised(self, theta: Theta) -> tuple[Float[Array, "n p m"], Field]:
        """Derivatives of the weighted model in theta, and weighted residuals."""
        x, y, S, Sh, Sk = self._saddle(theta)
        f = theta.astype(np.float32)[:, :, None]
        k = self.light.shape[1]
        level = np.matmul(f[:, GEOMETRY : GEOMETRY + k, 0][:, None], self.light)[:, 0]
        gain = np.matmul(f[:, GEOMETRY + k :, 0][:, None], self.light)[:, 0]
        J = np.empty((len(theta), theta.shape[1], x.shape[1]), dtype=np.float32)
        Sh *= gain
        Sk *= gain
        J[:, 0] = -(f[:, 2] * Sh + f[:, 4] * Sk)
        J[:, 1] = -(f[:, 3] * Sh + f[:, 5] * Sk)
        for slope, first, sag in ((Sh, 2, self.sag[0]), (Sk, 4, self.sag[1])):
            size = np.hypot(f[:, first], f[:, first + 1])
            J[:, first] = slope * (x - (f[:, first] / size) * sag)
            J[:, first + 1] = slope * (y - (f[:, first + 1] / size) * sag)
        J[:, GEOMETRY : GEOMETRY + k] = self.light
        np.multiply(self.light, S[:, None], out=J[:, GEOMETRY + k :])
        return J, self.target - level - S * gain

    def with_best_light(self, geometry: Float[Array, "n 6"]) -> Theta:
        """Theta of that geometry with the levels and contrasts solved for, which are linear."""
        S = self._saddle(geometry)[2]
        columns = np.concatenate([self.light, self.light * S[:, None]], axis=1)
        G = np.matmul(columns, columns.transpose(0, 2, 1)).astype(float)
        right = np.matmul(columns, self.target[:, :, None]).astype(float)
        ridge = 1e-6 * np.trace(G, axis1=1, axis2=2)[:, None, None] + 1e-9
        light = np.linalg.solve(G + ridge * np.eye(G.shape[1]), right)[:, :, 0]
        return np.concatenate([geometry, light], axis=1)

    def _saddle(self, theta: Theta) -> tuple[Field, Field, Field, Field, Field]:
        """Offsets from the corner, and the saddle with its derivatives across the edges."""
        f = theta.astype(np.float32)[:, :GEOMETRY, None]
        x, y = self.u - f[:, 0], self.v - f[:, 1]
        h = f[:, 2] * x + f[:, 3] * y - np.hypot(f[:, 2], f[:, 3]) * self.sag[0]
        k = f[:, 4] * x + f[:, 5] * y - np.hypot(f[:, 4], f[:, 5]) * self.sag[1]
        return x, y, *blurred_saddle(h, k, (theta[:, 2:4], theta[:, 4:6]), self.correlation)
