"""The saddle fit finds corners where they truly are, says how well, and beats OpenCV's two ways twofold."""

from functools import cache

import cv2
import numpy as np
import pytest

from tests.chessboard_pictures import BOARD, CAMERA, FINE, Picture, disc, picture, posed
from vision_robot.calibrate.boards.chessboard_order import canonical_grid
from vision_robot.calibrate.saddle import LOST_PX, fit_grid

SIZE = (BOARD.columns, BOARD.rows)
SHAPE = (BOARD.rows, BOARD.columns, 2)


def rms(errors: np.ndarray) -> float:
    return float(np.sqrt((errors**2).mean()))


def shaken(truth: np.ndarray, px: float = 0.4) -> np.ndarray:
    """Starts off by up to `px` per axis."""
    return truth + np.random.default_rng(1).uniform(-px, px, truth.shape)


def gaussian(sigma_px: float) -> np.ndarray:
    line = cv2.getGaussianKernel(2 * int(4 * sigma_px * FINE) + 1, sigma_px * FINE)
    return line @ line.T


@cache
def degraded(kind: str) -> tuple[Picture, ...]:
    """Two pictures under one kind of trouble, all seen through a lens that bends lines."""
    uu, vv = np.meshgrid(np.linspace(0, 1, CAMERA.width), np.linspace(0, 1, CAMERA.height))
    poses = {"oblique": {"tilt_deg": (60, 68), "distance_m": 0.27}, "small squares": {"distance_m": 0.8}}
    trouble = {
        "clean": {},
        "noise": {"blur": gaussian(0.5), "noise": 10},
        "blur": {"blur": disc(4), "noise": 1},
        "strong blur": {"blur": disc(6), "noise": 1},
        "low contrast": {"blur": gaussian(0.7), "levels": (113, 143), "noise": 4},
        "oblique": {"blur": gaussian(0.6), "noise": 1},
        "small squares": {"blur": gaussian(0.5), "noise": 1},
        "uneven light": {"blur": gaussian(0.7), "light": 0.35 + 0.75 * uu * vv, "noise": 1},
    }
    return tuple(picture(posed(seed, **poses.get(kind, {})), **trouble[kind], seed=seed) for seed in (3, 4))


KINDS = [
    ("clean", 0.008),
    ("noise", 0.018),
    ("blur", 0.008),
    ("strong blur", 0.02),
    ("low contrast", 0.05),
    ("oblique", 0.008),
    ("small squares", 0.006),
    ("uneven light", 0.008),
]


@pytest.mark.parametrize(("kind", "limit_px"), KINDS)
def test_error_to_truth_is_less_than_half_of_opencvs(kind, limit_px):
    """Under every degradation, against the better of cornerSubPix and SB on the same pictures."""
    ours, gradients, sectors = [], [], []
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 40, 0.001)
    for shot in degraded(kind):
        ours.append(fit_grid(shot.grey, shaken(shot.corners).reshape(SHAPE)).pixels - shot.corners)
        start = shaken(shot.corners).astype(np.float32).reshape(-1, 1, 2)
        refined = cv2.cornerSubPix(shot.grey, start, (5, 5), (-1, -1), stop)
        gradients.append(refined.reshape(-1, 2) - shot.corners)
        flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_EXHAUSTIVE
        found, pixels = cv2.findChessboardCornersSB(shot.grey, SIZE, flags=flags)
        if found:
            grid = canonical_grid(shot.grey, np.asarray(pixels, dtype=float).reshape(SHAPE), SIZE)
            sectors.append(grid.reshape(-1, 2) - shot.corners)
    assert rms(np.concatenate(ours)) < limit_px
    peers = [rms(np.concatenate(errors)) for errors in (gradients, sectors) if errors]
    assert rms(np.concatenate(ours)) < 0.5 * min(peers)


@pytest.mark.parametrize("kind", ["noise", "low contrast"])
def test_covariance_is_honest_where_noise_dominates(kind):
    """Squared errors over their covariance average to the two degrees of freedom."""
    chi2 = []
    for shot in degraded(kind):
        fit = fit_grid(shot.grey, shaken(shot.corners).reshape(SHAPE))
        error = fit.pixels - shot.corners
        chi2.append(np.einsum("ni,nij,nj->n", error, np.linalg.inv(fit.covariance), error) / 2)
    assert 0.7 < np.mean(chi2) < 1.4


def test_sigma_grows_with_the_noise():
    """Ten times the noise, ten times the sigma."""
    pose = posed(1)
    sigma = [
        np.median(fit_grid(shot.grey, shot.corners.reshape(SHAPE)).sigma_px)
        for shot in (picture(pose, blur=gaussian(0.7), noise=n) for n in (3, 30))
    ]
    assert sigma[1] / sigma[0] == pytest.approx(10, rel=0.25)


@pytest.mark.parametrize("sigma_px", [0.8, 1.5, 3.0])
def test_blur_is_measured(sigma_px):
    """A Gaussian blur comes back, the pixel's own extent added in squares."""
    shot = picture(posed(1), blur=gaussian(sigma_px))
    blur = np.median(fit_grid(shot.grey, shot.corners.reshape(SHAPE)).blur_px)
    assert blur == pytest.approx(np.sqrt(sigma_px**2 + 1 / 12), rel=0.03)


def test_start_does_not_matter():
    """Starts off by a pixel and a half end at the same place."""
    shot = picture(posed(2), blur=gaussian(0.7), noise=2)
    near, far = (fit_grid(shot.grey, shaken(shot.corners, px).reshape(SHAPE)) for px in (0.05, 1.5))
    assert near.fitted.all()
    assert far.fitted.all()
    assert np.abs(near.pixels - far.pixels).max() < 0.01


def test_half_turn_of_the_picture_turns_the_corners():
    """No direction is preferred: the fit of the turned picture is the turned fit."""
    shot = picture(posed(2), blur=disc(1.5), noise=2)
    grid = shot.corners.reshape(SHAPE)
    last = np.array([CAMERA.width - 1, CAMERA.height - 1])
    straight = fit_grid(shot.grey, grid)
    turned = fit_grid(np.ascontiguousarray(shot.grey[::-1, ::-1]), last - grid)
    assert np.abs(last - turned.pixels - straight.pixels).max() < 2e-3


def test_lost_corners_keep_their_start_and_say_so():
    """A corner under a blot is not fitted; its neighbours are."""
    shot = picture(posed(1), blur=gaussian(0.7), noise=1)
    u, v = np.rint(shot.corners[34]).astype(int)
    shot.grey[v - 25 : v + 26, u - 25 : u + 26] = 128
    start = shaken(shot.corners, 0.2)
    fit = fit_grid(shot.grey, start.reshape(SHAPE))
    assert (
        fit.sigma_px[34] >= LOST_PX
        or np.linalg.norm(fit.pixels[34] - shot.corners[34]) < 3 * fit.sigma_px[34]
    )
    assert np.isfinite(fit.pixels).all()
    assert np.abs(fit.pixels[0] - shot.corners[0]).max() < 0.05


@pytest.mark.parametrize("grey", [0, 255])
def test_blank_picture_is_survived(grey):
    """No contrast at all: nothing is fitted, nothing is raised, nothing is NaN but the blur."""
    blank = np.full((360, 480), grey, dtype=np.uint8)
    fit = fit_grid(blank, posed_grid())
    assert np.isfinite(fit.pixels).all()
    assert (fit.sigma_px > 0.5).all()


def posed_grid() -> np.ndarray:
    return CAMERA.project(posed(1).apply(BOARD.points)).reshape(SHAPE)
