"""What to do about a calibration, in sentences that each carry the number that justifies them.

All sentences are about something that is wrong or missing; a calibration that needs nothing
gets none. What matters most comes first.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from vision_robot.calibrate.judgement.corner_positions import corners_in_cam
from vision_robot.calibrate.judgement.picture import Picture
from vision_robot.calibrate.judgement.projection_uncertainty import picture_grid, projection_covariance
from vision_robot.calibrate.judgement.whiteness import neighbour_correlation
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.errors import BadParameter
from vision_robot.geometry.camera import AFFINE_NAMES
from vision_robot.types import Array, Bool, Float

__all__ = ["advice", "advice_by_topic", "outlying_views"]

REGIONS = (
    *("upper left corner", "upper edge", "upper right corner"),
    *("left edge", "middle", "right edge"),
    *("lower left corner", "lower edge", "lower right corner"),
)
"""Of the picture's 3x3 parts; a corner or edge counts as its outer half."""

UNSEEN_FACTOR = 2.0
"""Times the uncertainty in the best third of the picture, from which a part without corners is a gap."""
ROUGH = 0.01
"""Share of the diagonal past which uncertainty is no longer proportional to the noise."""
STEEP = np.radians(20)
FEW_STEEP = 3
"""Fewer steep views than these let a single one decide the focal length."""
ONE_AXIS = 0.15
"""Lean about the second axis over that about the first, below which the second counts as missing."""
FEW_VIEWS = 10
FAR_TO_NEAR = 1.25
MANY_MORE = 10
"""Times the views there are: nobody takes so many more of the same kind."""
BAD_VIEW = 2.0
MOST_NAMED = 4
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
    sentences = [sentence for said in advice_by_topic(result).values() for sentence in said]
    return sentences if wanted_px is None else [*_enough(result, wanted_px), *sentences]


def advice_by_topic(result: CalibrationResult) -> dict[str, tuple[str, ...]]:
    """The sentences of `advice` by what they are about, topics without any included.

    Topics, in the order of `advice`: "determined", "residuals", "views", "coverage", "tilt",
    "distance", "count", "ties", "significance".
    """
    rules = {
        "determined": _undetermined,
        "residuals": _residuals,
        "views": _views,
        "coverage": _coverage,
        "tilt": _tilt,
        "distance": _distance,
        "count": _count,
        "ties": _ties,
        "significance": _significance,
    }
    return {topic: tuple(rule(result)) for topic, rule in rules.items()}


def outlying_views(result: CalibrationResult) -> Bool[Array, "views"]:
    """Views whose rms is at least twice the median one, and more than chance would make it."""
    rms = result.view_rms_px
    corners = np.array([len(view) for view in result.corners])
    # The mean of 2n squares of noise scatters by 1/sqrt(n) of itself, its root by half of that.
    return rms > np.maximum(BAD_VIEW, 1 + SURE_Z / (2 * np.sqrt(corners))) * np.median(rms)


def _enough(result: CalibrationResult, wanted_px: float) -> Iterator[str]:
    sigma = float(np.sqrt(np.sum(Picture.of(result.camera).weight() * result.covariance.intrinsics)))
    if sigma > wanted_px:
        views = len(result.corners)
        # Noise falls with the root of the number of views of one kind.
        more = int(np.ceil(views * ((sigma / wanted_px) ** 2 - 1)))
        like = f"about {more} more views like these {views} would do, fewer chosen as the next best view."
        yield (
            f"The projection is known to {_number(sigma)} px, {_number(wanted_px)} px are asked for: "
            + (
                like
                if more <= MANY_MORE * views
                else f"no number of views like these {views} will do; choose others."
            )
        )


def _undetermined(result: CalibrationResult) -> Iterator[str]:
    lost = result.covariance.undetermined
    if lost:
        them = "it" if len(lost) == 1 else "them"
        yield (
            f"These {len(result.corners)} views do not determine {_listed(lost)}, and no sigma is stated for "
            f"{them}: fix {them} or take a simpler model, unless views with more tilt or at the rim can tell."
        )


def _residuals(result: CalibrationResult) -> Iterator[str]:
    near = neighbour_correlation(result)
    if np.isfinite(near.sigma) and near.z > SURE_Z and near.value > NEIGHBOURS:
        yield (
            f"The residuals of neighbouring corners correlate by {near.value:.2f} where noise alone gives "
            f"0 ± {_number(near.sigma, 1)}: the lens model or the flat board is too simple, or the detector "
            "errs by place. What is systematic is in no sigma, so every sigma is too small. Take a richer "
            "model or let the board's shape free."
        )


def _views(result: CalibrationResult) -> Iterator[str]:
    rms = result.view_rms_px
    median = float(np.median(rms))
    worst = [int(i) for i in np.argsort(-rms) if outlying_views(result)[i]]
    if worst:
        named = [
            f"{result.corners[i].image} ({_number(rms[i])} px, {rms[i] / median:.1f} times the median)"
            for i in worst[:MOST_NAMED]
        ]
        named += [f"{len(worst) - MOST_NAMED} more"] if len(worst) > MOST_NAMED else []
        verb, them = ("fits", "it") if len(worst) == 1 else ("fit", "them")
        yield (
            f"{_listed(named)} {verb} much worse than the median view, whose rms is {_number(median)} px: "
            f"look for blur, a bent board or a misplaced corner, and take {them} again."
        )


def _coverage(result: CalibrationResult) -> Iterator[str]:
    camera = result.camera
    picture = Picture.of(camera)
    variance = picture.variance(result.covariance.intrinsics)
    best = float(np.sqrt(np.quantile(variance, 1 / 3)))
    pixels = np.concatenate([view.pixels for view in result.corners])
    size = np.array([camera.width, camera.height])
    missing, worst = [], 0.0
    for i, name in enumerate(REGIONS):
        here = _inside(picture.pixels, size, i)
        if not here.any() or _inside(pixels, size, i).any():
            continue
        sigma = float(np.sqrt(np.mean(variance[here])))
        if sigma > UNSEEN_FACTOR * best:
            missing.append(f"{name} ({'' if missing else 'projection uncertain by '}{_number(sigma)} px)")
            worst = max(worst, sigma)
    if missing:
        rough = " Numbers so large tell no more than the order." if worst > ROUGH * np.hypot(*size) else ""
        yield (
            f"No board corner was seen in the {_listed(missing)} of the picture, against {_number(best)} px "
            f"in its best third.{rough} Add views that show the board there."
        )
    known = np.isfinite(projection_covariance(result, picture_grid(camera, 24, 18))[..., 0, 0])
    folded = 1 - float(known.mean())
    if folded:
        yield (
            f"The fitted lens folds over in {_number(100 * folded)} % of the picture and has no ray there, "
            "so nothing can be measured: show the board there, or take a simpler model."
        )


def _tilt(result: CalibrationResult) -> Iterator[str]:
    normals = result.cam_from_board.rotation[:, :, 2]
    mean = normals.mean(axis=0)
    lean = np.arccos(np.clip(normals @ mean / np.linalg.norm(mean), -1, 1))
    steep = int((lean >= STEEP).sum())
    if steep < FEW_STEEP:
        yield (
            f"The boards are hardly tilted against each other: {steep} of {len(lean)} by "
            f"{np.degrees(STEEP):.0f}° or more from their mean, the most by {np.degrees(lean.max()):.0f}°. "
            "Tilt is what tells the focal length from the distance: add views tilted by 30° to 50° in "
            "different directions."
        )
        return
    across = (normals - mean)[:, :2]
    (least, most), directions = np.linalg.eigh(across.T @ across)
    if least < ONE_AXIS**2 * most:
        missing = directions[:, 0]
        edges = "left or right" if abs(missing[0]) > abs(missing[1]) else "upper or lower"
        times = np.sqrt(most / max(least, 1e-12))
        much = f"{times:.0f} times" if times < 100 else "more than 100 times"
        yield (
            f"The boards are tilted about one axis {much} as much as about the axis across it: add "
            f"views with the {edges} edge of the board away from the camera."
        )


def _distance(result: CalibrationResult) -> Iterator[str]:
    distance = [np.linalg.norm(np.nanmean(points, axis=0)) for points in corners_in_cam(result)]
    near, far = float(np.nanmin(distance)), float(np.nanmax(distance))
    if far < FAR_TO_NEAR * near:
        yield (
            f"The farthest board, at {1000 * far:.0f} mm, stood only {far / near:.2f} times as far away as "
            f"the nearest, at {1000 * near:.0f} mm: add nearer and farther ones, which test the lens better."
        )


def _count(result: CalibrationResult) -> Iterator[str]:
    views = len(result.corners)
    if views < FEW_VIEWS:
        yield (
            f"Only {views} {'views were' if views > 1 else 'view was'} used: twice as many of the same kind "
            "would make every sigma smaller by a factor of about 1.4."
        )


def _ties(result: CalibrationResult) -> Iterator[str]:
    # `sigma` names nothing undetermined: of that more is said than that it is tied.
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
        f"{name} = {_with_sigma(values[name], sigma)}"
        for name, sigma in result.sigma.items()
        if name not in needed and abs(values[name]) < SIGNIFICANT * sigma
    ]
    if small:
        one = len(small) == 1
        yield (
            f"{'' if one else 'Taken one at a time, '}{_listed(small)} {'does' if one else 'do'} not differ "
            f"from zero by two sigma: a model without {'it' if one else 'one of them'} may predict as well. "
            "Views held back from the fit would tell; the rms cannot."
        )


def _inside(pixels: Float[Array, "n 2"], size: Array, region: int) -> Bool[Array, "n"]:
    """Which pixels lie in one of REGIONS: the outer sixths of corners and edges, the middle third."""
    row, column = divmod(region, 3)
    low = np.array([(0, 1 / 3, 5 / 6)[column], (0, 1 / 3, 5 / 6)[row]])
    high = np.array([(1 / 6, 2 / 3, 1)[column], (1 / 6, 2 / 3, 1)[row]])
    where = pixels / size
    return np.all((where >= low) & (where <= high), axis=1)


def _listed(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]


def _number(value: float, digits: int = 2) -> str:
    """To so many digits and never with an exponent: 350, 25, 0.38, 0.00012."""
    return np.format_float_positional(value, precision=digits, unique=False, fractional=False, trim="-")


def _with_sigma(value: float, sigma: float) -> str:
    """Both to the second digit of sigma: 18 ± 10, 0.0003 ± 0.0081."""
    decimals = max(0, 1 - int(np.floor(np.log10(sigma)))) if sigma > 0 else 6
    return f"{value:.{decimals}f} ± {sigma:.{decimals}f}"
