"""What to do about a calibration, in sentences that each carry the number that justifies them.

All sentences are about something that is wrong or missing; a calibration that needs nothing
gets none. What matters most comes first.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from vision_robot.calibrate.corner_positions import corners_in_cam
from vision_robot.calibrate.identifiability import tilt_spread
from vision_robot.calibrate.picture import Picture
from vision_robot.calibrate.projection_uncertainty import projection_covariance
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.calibrate.whiteness import neighbour_correlation
from vision_robot.errors import BadParameter
from vision_robot.geometry.camera import AFFINE_NAMES
from vision_robot.types import Array, Bool, Float

__all__ = ["advice"]

REGIONS = (
    *("upper left corner", "upper edge", "upper right corner"),
    *("left edge", "middle", "right edge"),
    *("lower left corner", "lower edge", "lower right corner"),
)
"""Of the picture's 3x3 parts; a corner or edge counts as its outer half."""

UNSEEN_FACTOR = 2.0
"""Times the uncertainty in the best third of the picture, from which a part without corners is a gap."""
LITTLE_TILT = np.radians(20)
FAR_TO_NEAR = 1.25
MANY_MORE = 10
"""Times the views there are: nobody takes so many more of the same kind."""
BAD_VIEW = 2.0
SURE_Z = 4.0
"""Standard deviations: one in 30 000 by chance."""
SIGNIFICANT = 2.0
TIED = 0.98
"""Correlation between an affine parameter and a coefficient of the lens that wants better views."""
TIED_LENS = 0.998
"""Powers of the same radius are always strongly tied; from here on two do the work of one."""
NEIGHBOURS = 0.1


def advice(result: CalibrationResult, *, wanted_px: float | None = None) -> list[str]:
    """Sentences on what is missing, each with its number; none when all is well.

    Args:
        result: The calibration.
        wanted_px: Projection uncertainty that is asked for: root mean square over the picture of
            the length of the error, as `NextViews.sigma_px` [px].

    Raises:
        BadParameter: `wanted_px` is not positive.
    """
    if wanted_px is not None and not wanted_px > 0:
        raise BadParameter("wanted projection uncertainty", wanted_px, "positive, in pixels")
    rules = (_undetermined, _residuals, _views, _coverage, _tilt, _distance, _ties, _significance)
    sentences = [sentence for rule in rules for sentence in rule(result)]
    return sentences if wanted_px is None else [*_enough(result, wanted_px), *sentences]


def _enough(result: CalibrationResult, wanted_px: float) -> Iterator[str]:
    sigma = float(np.sqrt(np.sum(Picture.of(result.camera).weight() * result.covariance.intrinsics)))
    if sigma > wanted_px:
        views = len(result.corners)
        # Noise falls with the root of the number of views of one kind.
        more = int(np.ceil(views * ((sigma / wanted_px) ** 2 - 1)))
        like = f"about {more} more views like these {views} would do, fewer chosen as the next best view."
        yield (
            f"The projection is known to {sigma:.2g} px, {wanted_px:.2g} px are asked for: "
            + (
                like
                if more <= MANY_MORE * views
                else f"no number of views like these {views} will do; choose others."
            )
        )


def _undetermined(result: CalibrationResult) -> Iterator[str]:
    lost = result.covariance.undetermined
    if lost:
        views = len(result.corners)
        yield f"{_listed(lost)} cannot be told from these {views} views: fix them or take a simpler model."


def _residuals(result: CalibrationResult) -> Iterator[str]:
    near = neighbour_correlation(result)
    if np.isfinite(near.sigma) and near.z > SURE_Z and near.value > NEIGHBOURS:
        yield (
            f"The residuals of neighbouring corners agree with a correlation of {near.value:.2f} where noise "
            f"gives 0 ± {near.sigma:.1g}: the lens model or the flat board is too simple, and every sigma is "
            "too small. Let the board's shape free or take a richer model."
        )


def _views(result: CalibrationResult) -> Iterator[str]:
    rms = result.view_rms_px
    median = float(np.median(rms))
    corners = np.array([len(view) for view in result.corners])
    # The mean of 2n squares of noise scatters by 1/sqrt(n) of itself, its root by half of that.
    limit = np.maximum(BAD_VIEW, 1 + SURE_Z / (2 * np.sqrt(corners))) * median
    for i in np.argsort(-rms):
        if rms[i] > limit[i]:
            yield (
                f"View {result.corners[i].image} has an rms of {rms[i]:.2g} px, {rms[i] / median:.1f} times "
                "the median view: look for blur or a bent board, and take it again."
            )


def _coverage(result: CalibrationResult) -> Iterator[str]:
    camera = result.camera
    picture = Picture.of(camera)
    variance = picture.variance(result.covariance.intrinsics)
    best = float(np.sqrt(np.quantile(variance, 1 / 3)))
    pixels = np.concatenate([view.pixels for view in result.corners])
    size = np.array([camera.width, camera.height])
    missing = []
    for i, name in enumerate(REGIONS):
        here = _inside(picture.pixels, size, i)
        if not here.any() or _inside(pixels, size, i).any():
            continue
        sigma = float(np.sqrt(np.mean(variance[here])))
        if sigma > UNSEEN_FACTOR * best:
            missing.append(f"{name} ({sigma:.2g} px)")
    if missing:
        yield (
            f"No corner was seen in the {_listed(missing)} of the picture. So little is the projection known "
            f"there, against {best:.2g} px where it is known best: hold the board there."
        )
    folded = 1 - float(np.isfinite(projection_covariance(result, _grid(size))[..., 0, 0]).mean())
    if folded:
        yield (
            f"The fitted lens folds over in {100 * folded:.0f} % of the picture, where nothing can be "
            "measured: show the board there, or take a simpler model."
        )


def _tilt(result: CalibrationResult) -> Iterator[str]:
    spread = tilt_spread(result.cam_from_board)
    if spread < LITTLE_TILT:
        yield (
            f"The boards lean by no more than {np.degrees(spread):.0f}° from their mean: only tilt tells the "
            "focal length from the distance. Add views tilted by 30° to 50° in different directions."
        )
        return
    lean = result.cam_from_board.rotation[:, :2, 2]
    lean = lean - lean.mean(axis=0)
    least, most = np.linalg.eigvalsh(lean.T @ lean)
    if least < 0.15**2 * most:
        across = np.linalg.eigh(lean.T @ lean)[1][:, 0]
        edges = "left or right" if abs(across[0]) > abs(across[1]) else "upper or lower"
        times = np.sqrt(most / max(least, 1e-12))
        yield (
            f"The boards lean {times:.0f} times as much in one direction as across it: "
            f"add views with the {edges} edge of the board away from the camera."
        )


def _distance(result: CalibrationResult) -> Iterator[str]:
    distance = [np.linalg.norm(np.nanmean(points, axis=0)) for points in corners_in_cam(result)]
    ratio = float(np.nanmax(distance) / np.nanmin(distance))
    if ratio < FAR_TO_NEAR:
        yield (
            f"The farthest board stood only {ratio:.2f} times as far away as the nearest: add nearer and "
            "farther ones, which tell more of the lens."
        )


def _ties(result: CalibrationResult) -> Iterator[str]:
    names = [name for name in result.camera.parameter_names if name in result.sigma]
    index = [result.camera.parameter_names.index(name) for name in names]
    C = result.covariance.intrinsics[np.ix_(index, index)]
    sigma = np.sqrt(np.diag(C))
    correlation = C / np.maximum(np.outer(sigma, sigma), 1e-300)
    for i, first in enumerate(names):
        for j in range(i):
            affine = (first in AFFINE_NAMES) + (names[j] in AFFINE_NAMES)
            limit = {0: TIED_LENS, 1: TIED}.get(affine, np.inf)  # fx and fy always move together
            if abs(correlation[i, j]) > limit:
                cure = (
                    "a simpler model may do"
                    if affine == 0
                    else "views with more tilt and at the rim part them"
                )
                yield f"{names[j]} and {first} are correlated by {correlation[i, j]:.4f}: {cure}."


def _significance(result: CalibrationResult) -> Iterator[str]:
    values = dict(zip(result.camera.parameter_names, result.camera.parameters, strict=True))
    needed = {"fx", "fy", "cx", "cy", *result.settings.priors}
    small = [
        f"{name} = {values[name]:.2g} ± {sigma:.1g}"
        for name, sigma in result.sigma.items()
        if name not in needed and abs(values[name]) < SIGNIFICANT * sigma
    ]
    if small:
        which = "does not differ" if len(small) == 1 else "do not differ"
        yield f"{_listed(small)} {which} from zero by two sigma: a model without may predict as well."


def _inside(pixels: Float[Array, "n 2"], size: Array, region: int) -> Bool[Array, "n"]:
    """Which pixels lie in one of REGIONS: the outer sixths of corners and edges, the middle third."""
    row, column = divmod(region, 3)
    low = np.array([(0, 1 / 3, 5 / 6)[column], (0, 1 / 3, 5 / 6)[row]])
    high = np.array([(1 / 6, 2 / 3, 1)[column], (1 / 6, 2 / 3, 1)[row]])
    where = pixels / size
    return np.all((where >= low) & (where <= high), axis=1)


def _grid(size: Array) -> Float[Array, "h w 2"]:
    u, v = np.linspace(0, size[0] - 1, 24), np.linspace(0, size[1] - 1, 18)
    return np.stack(np.meshgrid(u, v), axis=-1)


def _listed(names: Sequence[str]) -> str:
    return " and ".join(", ".join(names).rsplit(", ", 1)) if len(names) > 1 else names[0]
