"""What symmetric and asymmetric circle grids share: finding the discs and measuring them."""

import numpy as np

from vision_robot.calibrate.boards.blobs import EllipseBlobs, dark_blobs
from vision_robot.calibrate.boards.ellipse_fit import fit_ellipses
from vision_robot.calibrate.boards.lattice import match_lattice
from vision_robot.calibrate.corners import Corners
from vision_robot.types import Array, Image, Int

__all__ = ["find_circles"]

LEAST_SHARE = 0.8
"""Share of the discs that must be measured well for the board to count as seen."""


def find_circles(image: Image, sites: Int[Array, "m 2"], *, reach: float, name: str = "") -> Corners | None:
    """Ellipse centres of a grid's discs, or None where the whole grid is not seen.

    `sites` are the lattice positions of the board's points in any basis that turns clockwise on
    the print; `reach` is half the distance to the nearest disc, in radii.
    """
    from vision_robot.calibrate.boards.chessboard_finder import grey_of

    grey = np.ascontiguousarray(grey_of(image))
    for blobs in dark_blobs(grey):
        match = match_lattice(blobs.centres, blobs.radii, sites)
        if match is None:
            continue
        ordered = EllipseBlobs(blobs.centres[match], blobs.spreads[match])
        fits = fit_ellipses(grey, ordered, reach=reach)
        if fits.good.mean() >= LEAST_SHARE:
            good = fits.good
            return Corners(name, np.flatnonzero(good), fits.centres[good], fits.sigma_px[good])
    return None
