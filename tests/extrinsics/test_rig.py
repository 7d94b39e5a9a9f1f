"""A rig of three cameras: truth within its sigma, and every way it cannot be known said in words."""

import numpy as np
import pytest

from tests.extrinsics.rigs import CAMERAS, NAMES, STAND, boards
from tests.extrinsics.table import BOARD
from vision_robot.calibrate import Corners
from vision_robot.errors import BadParameter, UnlinkedCameras, Unsynchronised
from vision_robot.extrinsics.plane_checks import pose_difference
from vision_robot.extrinsics.rig import RigFit, fit_rig
from vision_robot.extrinsics.rig_problem import RigProblem
from vision_robot.geometry import KnownCamera, triangulate

EXACT = [KnownCamera.exact(camera) for camera in CAMERAS]


def off(fit: RigFit) -> np.ndarray:
    """Steps (cameras - 1, 6) from the poses found to the true ones."""
    return np.array([pose_difference(fit.rig.cam_from_rig[i], STAND[i]) for i in (1, 2)])


def test_without_noise_it_is_the_truth():
    fit = fit_rig(NAMES, EXACT, boards(8, noise_px=0).sightings, BOARD)
    assert np.abs(off(fit)).max() < 1e-9
    assert fit.rejected == ()


def test_the_gradient_is_what_a_finite_step_does():
    from vision_robot.calibrate.observations import Observations
    from vision_robot.calibrate.warp import Warp
    from vision_robot.extrinsics.rig_problem import RigState

    made = boards(4)
    warp = Warp.smooth(BOARD, 3)
    warp = Warp(warp.basis, 1e-4 * np.arange(len(warp)), warp.names)
    size = sum(len(camera.parameters) + 6 for camera in CAMERAS) + len(warp)
    names = [f"{k:02d}.png" for k in range(4)]
    problem = RigProblem(
        tuple(Observations.of(list(seen.values()), BOARD) for seen in made.sightings),
        tuple(np.array([names.index(m) for m in seen], dtype=int) for seen in made.sightings),
        4,
        np.ones(size, dtype=bool),
        np.diag(np.linspace(0, 1, size)),
        tuple(camera.with_parameters(camera.parameters + 0.01) for camera in CAMERAS),
    )
    state = RigState(CAMERAS, STAND, made.rig_from_board, warp)
    found = problem.equations(state)
    gradient = np.concatenate([found.shared_gradient, found.pose_gradient.ravel()])
    scale = np.concatenate(
        [np.tile(np.r_[np.full(5, 1e-3), np.full(11, 1e-6)], 3), np.full(len(warp), 1e-6), np.full(24, 1e-6)]
    )
    for k in range(len(gradient)):
        step = np.zeros(len(gradient))
        step[k] = scale[k]
        costs = []
        for sign in (1, -1):
            at = state.moved(problem.free, (sign * step[:size], sign * step[size:].reshape(4, 6)))
            assert at is not None
            costs.append(problem.equations(at).cost)
        assert (costs[0] - costs[1]) / (2 * scale[k]) == pytest.approx(gradient[k], rel=2e-5, abs=0.05)


@pytest.mark.parametrize("refine", [False, True])
def test_the_covariance_holds_the_truth(refine):
    """Chi-square of both poses over many sets: twelve degrees of freedom."""
    chi = []
    for seed in range(10):
        fit = fit_rig(NAMES, EXACT, boards(8, seed=seed).sightings, BOARD, refine=refine)
        step = off(fit).ravel()
        rows = np.concatenate([np.arange(fit.rig.rows(i).stop - 6, fit.rig.rows(i).stop) for i in (1, 2)])
        covariance = fit.rig.covariance[np.ix_(rows, rows)]
        scale = 1 / np.sqrt(np.diag(covariance))
        chi.append(step * scale @ np.linalg.solve(covariance * scale[:, None] * scale, step * scale))
    assert np.mean(chi) == pytest.approx(12, abs=4 * np.sqrt(24 / 10))


def test_held_intrinsics_bring_their_own_uncertainty():
    """Rigs from cameras drawn from their covariance scatter as the joint covariance says."""
    rng = np.random.default_rng(0)
    sigma = np.array([1.0, 1, 1.5, 1.5, 0, 2e-3, 3e-3, 1e-4, 1e-4, 2e-3])
    known = [KnownCamera(camera, np.diag(sigma**2)) for camera in CAMERAS]
    made = boards(8, noise_px=0)
    stated = np.sqrt(np.diag(fit_rig(NAMES, known, made.sightings, BOARD).rig.covariance))
    steps = []
    for _ in range(16):
        drawn = [
            KnownCamera.exact(camera.with_parameters(camera.parameters + rng.normal(size=10) * sigma))
            for camera in CAMERAS
        ]
        steps.append(off(fit_rig(NAMES, drawn, made.sightings, BOARD, robust=False)))
    found = np.sqrt(np.mean(np.square(steps), axis=0)).ravel()
    stated = np.concatenate([stated[26:32], stated[42:48]])
    assert np.abs(np.log(found / stated)).max() < 0.8
    assert abs(np.mean(np.log(found / stated))) < 0.3


def test_known_intrinsics_are_refined_with_what_is_known_of_them():
    rng = np.random.default_rng(1)
    sigma = np.array([3.0, 3, 3, 3, 0, 5e-3, 1e-2, 5e-4, 5e-4, 5e-3])
    known = [
        KnownCamera(
            camera.with_parameters(camera.parameters + rng.normal(size=10) * sigma), np.diag(sigma**2)
        )
        for camera in CAMERAS
    ]
    made = boards(14, seed=3)
    held, refined = (
        fit_rig(NAMES, known, made.sightings, BOARD, refine=r, robust=False) for r in (False, True)
    )
    assert refined.rms_px < 0.95 * held.rms_px
    assert np.abs(off(refined)).sum() < np.abs(off(held)).sum()
    for before, after in zip(known, range(3), strict=True):
        mine = refined.rig.known_camera(after).sigma
        assert all(mine[name] < value for name, value in before.sigma.items())


def test_triangulated_points_miss_the_truth_by_their_sigma():
    rng = np.random.default_rng(5)
    points = rng.uniform([-0.1, -0.15, 0.7], [0.2, 0.1, 0.95], (60, 3))
    clean = np.stack([camera.project(STAND[i].apply(points)) for i, camera in enumerate(CAMERAS)], axis=1)
    white = []
    for seed in range(8):
        rig = fit_rig(NAMES, EXACT, boards(8, seed=100 + seed).sightings, BOARD).rig
        found = triangulate(rig, clean + 0.2 * rng.normal(size=clean.shape), 0.2)
        error = found.points - points
        white.append(np.einsum("ni,nij,nj->n", error, np.linalg.inv(found.covariance), error))
    assert np.sqrt(np.mean(white) / 3) == pytest.approx(1, abs=0.15)


def test_a_bent_board_is_estimated_once_for_all_cameras():
    bent = BOARD + np.stack([0 * BOARD[:, 0], 0 * BOARD[:, 0], 4e-4 * np.cos(20 * BOARD[:, 0])], axis=1)
    made = boards(10, noise_px=0.05)
    sightings = []
    for i, camera in enumerate(CAMERAS):
        seen = {}
        for name, view in made.sightings[i].items():
            pose = STAND[i] @ made.rig_from_board[int(name[:2])]
            noise = view.pixels - camera.project(pose.apply(BOARD))
            seen[name] = Corners(view.image, view.ids, camera.project(pose.apply(bent)) + noise)
        sightings.append(seen)
    flat, warped = (fit_rig(NAMES, EXACT, sightings, BOARD, warp=degree) for degree in (0, 4))
    assert warped.rms_px < 0.75 * flat.rms_px
    assert np.sqrt(np.mean(warped.warp.displacement[:, 2] ** 2)) > 5e-5


def test_cameras_that_share_no_moment_are_named():
    made = boards(8).sightings
    made[2] = {f"other {name}": view for name, view in made[2].items()}
    with pytest.raises(UnlinkedCameras, match="top never saw the board at the same moment as left, right"):
        fit_rig(NAMES, EXACT, made, BOARD)


def test_a_chain_of_pairs_is_enough():
    """left and top share nothing, but both share moments with right."""
    made = boards(12).sightings
    names = list(made[1])
    made[0] = {name: view for name, view in made[0].items() if name in names[:6]}
    made[2] = {name: view for name, view in made[2].items() if name in names[6:]}
    fit = fit_rig(NAMES, EXACT, made, BOARD)
    assert fit.common[0, 2] == 0
    assert np.abs(off(fit)).max() < 0.01


def test_pictures_of_other_moments_are_found_with_their_lag():
    made = boards(14).sightings
    names = [f"{k:02d}.png" for k in range(14)]
    made[1] = {names[int(name[:2]) + 2]: view for name, view in made[1].items() if int(name[:2]) + 2 < 14}
    with pytest.raises(Unsynchronised, match=r"picture k of left goes with k\+2 of right"):
        fit_rig(NAMES[:2], EXACT[:2], made[:2], BOARD)
    shuffled = dict(zip(made[0], reversed(list(made[0].values())), strict=True))
    with pytest.raises(Unsynchronised, match="at the same moment") as caught:
        fit_rig(NAMES[:2], EXACT[:2], [shuffled, boards(14).sightings[1]], BOARD)
    assert caught.value.lag is None


def test_one_mistimed_picture_and_one_wrong_corner_are_left_out_by_name():
    made = boards(12).sightings
    names = list(made[1])
    made[1][names[3]] = Corners("x", made[1][names[3]].ids, made[1][names[4]].pixels)
    first = next(iter(made[0]))
    pixels = made[0][first].pixels.copy()
    pixels[10] += [6, 0]
    made[0][first] = Corners("y", np.arange(len(BOARD)), pixels)
    fit = fit_rig(NAMES, EXACT, made, BOARD)
    said = {(one.image, one.corner) for one in fit.rejected}
    assert (f"right: {names[3]}", None) in said
    assert any(corner == 10 for image, corner in said if image.startswith("left"))
    assert np.abs(off(fit)).max() < 5e-3


def test_counts_must_agree():
    with pytest.raises(BadParameter, match="two or more"):
        fit_rig(NAMES[:1], EXACT[:1], boards(3).sightings[:1], BOARD)
