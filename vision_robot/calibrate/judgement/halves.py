"""Cross-validation between halves: two calibrations that share no view, against what they claim.

If the covariances are honest, the cameras of two halves A and B differ at a pixel q by
d(q) with covariance C_A(q) + C_B(q), so that

    ratio^2 = mean over splits and picture of |d|^2 / tr(C_A + C_B)

has the mean one. Each pixel is measured by its own prediction, lest the corners of the
picture, where nothing was seen, drown the rest. A turn between the cameras' frames is
taken out (see `Picture`). A ratio well above one says that views disagree by more
than their corners' noise: the lens is not of that model, or the board is bent or moved.
What is wrong in both halves alike stays unseen.
"""

from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.identifiability import identified
from vision_robot.calibrate.judgement.picture import Picture
from vision_robot.calibrate.judgement.solution import solution
from vision_robot.calibrate.judgement.view_blocks import ViewBlocks
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.errors import BadParameter, DegenerateViews, NoConvergence, TooFewViews
from vision_robot.geometry import Camera
from vision_robot.types import Array, Float

__all__ = ["Halves", "compare_halves"]

FEWEST_IN_HALF = 3
TRIES = 3
"""A split whose halves cannot be calibrated is drawn anew, up to so many times."""

UNLIKELY = 0.01
IMAGINED = 1000


@dataclass(frozen=True)
class Halves:
    """A row for each split: `found_px` how far its two cameras lie apart, root mean square over
    the picture, and `predicted_px` what their covariances say; `ratios` of the two, pixel by pixel.
    `chance` is how often a right model gives as large a `ratio`, as imagined from the covariances.
    """

    found_px: Float[Array, "splits"]
    predicted_px: Float[Array, "splits"]
    ratios: Float[Array, "splits"]
    chance: float

    @property
    def ratio(self) -> float:
        """Root mean square of `ratios`; about one where the covariances are honest."""
        return _ratio(self.ratios)

    @property
    def honest(self) -> bool:
        """Whether the halves agree as well as their covariances say, as far as these views can tell."""
        return self.chance >= UNLIKELY

    @property
    def sentence(self) -> str:
        """The same in words."""
        apart = f"two halves of the views give cameras {np.median(self.found_px):.2g} px apart"
        if self.honest:
            return f"{apart}, {self.ratio:.1f} times what their covariances say: the stated sigmas hold"
        return (
            f"{apart}, {self.ratio:.1f} times as far as their covariances say (by chance once in "
            f"{1 / max(self.chance, 1 / IMAGINED):.0f}): the lens model, the board or a view is wrong, "
            "and the stated sigmas are too small"
        )


def compare_halves(
    result: CalibrationResult, board_points: Float[Array, "m 3"], *, splits: int = 10, seed: int = 0
) -> Halves:
    """Split the views at random, calibrate both halves, compare; `splits` times.

    `board_points` (m, 3) [m] are those given to `calibrate`. Raises TooFewViews below six
    views, NoConvergence where no split leaves two halves that can be calibrated.
    """
    views = len(result.corners)
    if views < 2 * FEWEST_IN_HALF:
        raise TooFewViews(views, 2 * FEWEST_IN_HALF, views)
    if splits < 1:
        raise BadParameter("splits", splits, "one or more")
    blocks = ViewBlocks.of(*solution(result, board_points))
    rng = np.random.default_rng(seed)
    rows, halves = [], []
    for _ in range(TRIES * splits):
        if len(rows) == splits:
            break
        half = np.zeros(views)
        half[rng.permutation(views)[: views // 2]] = 1
        try:
            rows.append(_compared(_calibrated(blocks, half), _calibrated(blocks, 1 - half)))
        except (DegenerateViews, NoConvergence):
            continue
        halves.append(half)
    if not rows:
        raise NoConvergence("no split leaves two halves of the views that can be calibrated: add views")
    found, predicted, ratios = np.array(rows).T
    imagined = _imagined(blocks, np.array(halves), rng)
    return Halves(found, predicted, ratios, float(np.mean(imagined >= _ratio(ratios))))


def _calibrated(blocks: ViewBlocks, weights: Float[Array, "views"]) -> tuple[Camera, Array]:
    """Camera of the views that count, and the covariance of its parameters."""
    step = blocks.steps(weights[None])[0]
    end = blocks.refitted(weights, np.nan_to_num(step))
    return end.state.camera, identified(end, blocks.weighted(weights)).intrinsics


def _compared(first: tuple[Camera, Array], second: tuple[Camera, Array]) -> tuple[float, float, float]:
    """Distance found and predicted, both root mean square over the picture, and ratio of a split."""
    one, other = Picture.of(first[0]), Picture.of(second[0])
    # Both on the same grid, but each with the pixels where it has a ray.
    place, i, j = np.intersect1d(one.pixels @ [1, 1j], other.pixels @ [1, 1j], return_indices=True)
    predicted = one.variance(first[1])[i] + other.variance(second[1])[j]
    found = np.sum(one.difference(second[0])[i] ** 2, axis=1)
    known = np.isfinite(found)
    if not (len(place) and known.any()):
        raise NoConvergence("the cameras of two halves share no ray")
    found, predicted = found[known], predicted[known]
    return np.sqrt(found.mean()), np.sqrt(predicted.mean()), np.sqrt(np.mean(found / predicted))


def _imagined(blocks: ViewBlocks, halves: Float[Array, "splits views"], rng: np.random.Generator) -> Array:
    """Ratios that right models give for the same splits, to first order."""
    weights = np.concatenate([halves, 1 - halves])
    steps = blocks.imagined_steps(weights, IMAGINED, rng)
    apart = steps[:, : len(halves)] - steps[:, len(halves) :]
    spread = blocks.spread(weights) + blocks.variance * np.eye(steps.shape[-1])
    spread = spread[: len(halves)] + spread[len(halves) :]
    gain = Picture.of(blocks.state.camera).gain
    in_steps = gain @ blocks.parameters(np.eye(steps.shape[-1]))[:, : gain.shape[-1]].T
    predicted = np.einsum("nik,skl,nil->sn", in_steps, spread, in_steps)
    # The mean over the picture of |d|^2 / predicted is a quadratic form in the step.
    form = np.einsum("nik,nil,sn->skl", in_steps, in_steps, 1 / predicted) / len(in_steps)
    return np.sqrt(np.einsum("csk,skl,csl->cs", apart, form, apart).mean(axis=1))


def _ratio(ratios: Array) -> float:
    return float(np.sqrt(np.mean(ratios**2)))
