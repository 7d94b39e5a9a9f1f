"""What a detector saw in one picture."""

from dataclasses import dataclass, field

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float, Int

__all__ = ["Corners"]


@dataclass(frozen=True)
class Corners:
    """Board corners found in one image.

    `ids` (n,) name the board points, `pixels` (n, 2) say where they were seen and
    `sigma_px` (n,) how well, as one standard deviation per axis [px] (one where it is unknown).
    """

    image: str
    ids: Int[Array, "n"]
    pixels: Float[Array, "n 2"]
    sigma_px: Float[Array, "n"] = field(default_factory=lambda: np.ones(()))

    def __post_init__(self) -> None:
        ids = np.asarray(self.ids, dtype=np.int64)
        pixels = np.asarray(self.pixels, dtype=float).reshape(-1, 2)
        sigma = np.asarray(self.sigma_px, dtype=float)
        sigma = np.full(len(ids), sigma) if sigma.ndim == 0 else sigma
        if not len(ids) == len(pixels) == len(sigma):
            lengths = (len(ids), len(pixels), len(sigma))
            raise BadParameter(f"corners of {self.image}: counts", lengths, "the same number of each")
        if not np.isfinite(pixels).all():
            raise BadParameter(f"corners of {self.image}", "not a number", "finite pixel coordinates")
        if len(np.unique(ids)) != len(ids) or (len(ids) and ids.min() < 0):
            raise BadParameter(f"corners of {self.image}: ids", ids.tolist(), "different and not negative")
        if not (np.isfinite(sigma).all() and (sigma > 0).all()):
            raise BadParameter(f"corners of {self.image}: sigma_px", sigma.tolist(), "positive")
        object.__setattr__(self, "ids", ids)
        object.__setattr__(self, "pixels", pixels)
        object.__setattr__(self, "sigma_px", sigma)

    def __len__(self) -> int:
        return len(self.ids)
