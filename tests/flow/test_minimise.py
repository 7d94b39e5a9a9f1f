"""Proves that the solver reaches the minimiser, that its distance is true, and that sweeps stay away."""

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import spsolve

from tests.flow_scenes import Layer, affine, ellipse, noise_texture, rendered
from vision_robot.errors import BadParameter
from vision_robot.flow import FlowEquations, Multigrid, cube, horn_schunck, horn_schunck_sweeps, minimise
from vision_robot.flow.averaging import KERNEL


def pictures(size, seed=0, noise=2.0):
    """A textured object over a textured table, both moving a little."""
    width, height = size
    centre = (0.55 * width, 0.45 * height)
    layers = [
        Layer(noise_texture(size, seed=seed), affine((0.4, -0.3))),
        Layer(
            noise_texture(size, seed=seed + 1, contrast=60),
            affine((-0.9, 0.7), turn_deg=2, about=centre),
            ellipse(centre, (width / 5, height / 4)),
        ),
    ]
    pair = rendered(layers, size, noise=noise, seed=seed)
    return pair.first, pair.second


def direct(equations):
    """The minimiser by a sparse factorisation; nothing of the solver is used but the equations' arrays."""
    height, width = equations.shape
    n = height * width
    index = np.arange(n).reshape(height, width)
    bond = np.ones((height, width)) if equations.bond is None else equations.bond.astype(float)
    rows, columns, weights = [], [], []
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            weight = float(KERNEL[dy + 1, dx + 1])
            there = index[
                np.clip(np.arange(height) + dy, 0, height - 1)[:, None],
                np.clip(np.arange(width) + dx, 0, width - 1)[None, :],
            ]
            rows.append(index.ravel())
            columns.append(there.ravel())
            weights.append(weight * (bond.ravel() + bond.ravel()[there.ravel()]) / 2)
    pulls = sparse.csr_matrix(
        (np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))), shape=(n, n)
    )
    smooth = sparse.diags(np.asarray(pulls.sum(axis=1)).ravel()) - pulls
    x, y, t = (plane.astype(float).ravel() for plane in (equations.x, equations.y, equations.t))
    c = equations.alpha**2
    matrix = sparse.bmat(
        [
            [c * smooth + sparse.diags(x * x), sparse.diags(x * y)],
            [sparse.diags(x * y), c * smooth + sparse.diags(y * y)],
        ]
    )
    return np.asarray(spsolve(matrix.tocsc(), -np.concatenate([x * t, y * t]))).reshape(2, height, width)


def rms(difference):
    return float(np.sqrt((difference**2).sum(axis=0).mean()))


@pytest.mark.parametrize("size", [(64, 48), (65, 47), (90, 71), (7, 5), (33, 2)])
@pytest.mark.parametrize("alpha", [3.0, 15.0, 60.0])
def test_it_is_the_minimiser(size, alpha):
    equations = FlowEquations(*cube(*pictures(size)), alpha)
    found = minimise(equations, tolerance_px=1e-4)
    assert rms(found.flow - direct(equations)) < 3e-4


def test_with_bonds_too():
    rng = np.random.default_rng(3)
    bond = rng.uniform(0.02, 1, (48, 64)).astype(np.float32)
    equations = FlowEquations(*cube(*pictures((64, 48))), 15.0, bond)
    found = minimise(equations, tolerance_px=1e-4)
    assert rms(found.flow - direct(equations)) < 3e-4


@pytest.mark.parametrize("size", [(160, 120), (161, 119), (200, 90)])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_distance_told_is_true(size, seed):
    first, second = pictures(size, seed=10 * seed)
    equations = FlowEquations(*cube(first, second), 8.0)
    truth = direct(equations)
    for tolerance in (0.1, 0.03, 0.01, 0.003):
        found = minimise(equations, tolerance_px=tolerance)
        distance = rms(found.flow - truth)
        assert found.distance_px <= tolerance
        assert distance <= 1.2 * found.distance_px
        assert found.distance_px < 0.01 * tolerance or distance > found.distance_px / 8


def test_the_residual_is_zero_and_the_energy_least_at_the_minimiser():
    x, y, t = (plane.astype(float) for plane in cube(*pictures((48, 40))))
    equations = FlowEquations(x, y, t, 15.0)
    best = direct(equations)
    assert np.abs(equations.residual(best)).max() < 1e-4
    rng = np.random.default_rng(0)
    least = equations.energy(best)
    for size in (1e-3, 1e-1):
        assert equations.energy(best + size * rng.normal(size=best.shape)) > least


def test_sweeps_go_to_the_same_minimiser_but_stop_far_from_it():
    first, second = pictures((120, 90))
    equations = FlowEquations(*cube(first, second), 15.0)
    truth = direct(equations)
    far = [rms(horn_schunck_sweeps(first, second, sweeps=n) - truth) for n in (10, 100, 4000)]
    assert far[0] > far[1] > 20 * far[2]
    assert far[1] > 0.01
    assert far[2] < 0.002
    assert rms(horn_schunck(first, second).flow - truth) < 0.01


def test_one_sweep_by_hand():
    """A ramp of slope 2 that rises by 1: from zero, u = −I_x I_t / (α² + I_x²), nothing averaged yet."""
    first = np.tile(2.0 * np.arange(9, dtype=np.float32), (7, 1))
    u, v = horn_schunck_sweeps(first, first + 1, alpha=3.0, sweeps=1)
    np.testing.assert_allclose(u[:-1, :-1], -2 / 13, rtol=1e-6)
    np.testing.assert_allclose(v, 0, atol=1e-7)


def test_flat_pictures_and_pictures_of_stripes_have_flow_of_least_norm():
    flat = np.full((40, 60), 90, np.uint8)
    assert np.abs(horn_schunck(flat, flat).flow).max() == 0
    stripes = np.tile(128 + 60 * np.sin(np.arange(60) / 4).astype(np.float32), (40, 1))
    moved = np.tile(128 + 60 * np.sin((np.arange(60) - 0.5) / 4).astype(np.float32), (40, 1))
    u, v = horn_schunck(stripes, moved, tolerance_px=1e-3).flow
    assert abs(u.mean() - 0.5) < 0.02
    assert np.abs(v).max() < 1e-3


@pytest.mark.parametrize("alpha", [0.05, 1.0, 2000.0])
def test_wild_pictures_do_not_make_it_diverge(alpha):
    rng = np.random.default_rng(1)
    first, second = rng.integers(0, 256, (2, 96, 128)).astype(np.uint8)
    equations = FlowEquations(*cube(first, second), alpha)
    found = minimise(equations, tolerance_px=1e-3, most_cycles=60)
    assert rms(found.flow - direct(equations)) < 5e-3


def test_a_good_start_saves_cycles_and_memory_is_taken_over():
    first, second = pictures((320, 240))
    equations = FlowEquations(*cube(first, second), 5.0)
    grids = Multigrid(equations.shape)
    cold = minimise(equations, tolerance_px=1e-3, grids=grids)
    warm = minimise(equations, tolerance_px=1e-3, grids=grids, start=cold.flow)
    assert warm.cycles < cold.cycles
    other = minimise(FlowEquations(*cube(second, first), 5.0), tolerance_px=1e-3, grids=grids)
    fresh = minimise(FlowEquations(*cube(second, first), 5.0), tolerance_px=1e-3)
    np.testing.assert_array_equal(other.flow, fresh.flow)


def test_strips_are_seamless(monkeypatch):
    first, second = pictures((160, 121))
    equations = FlowEquations(
        *cube(first, second), 15.0, np.linspace(0.1, 1, 160 * 121, dtype=np.float32).reshape(121, 160)
    )
    whole = minimise(equations, tolerance_px=1e-3).flow
    monkeypatch.setattr("vision_robot.flow.strips.PLANE_BYTES", 4 * 160 * 10)
    np.testing.assert_allclose(minimise(equations, tolerance_px=1e-3).flow, whole, atol=2e-5)


def test_bad_input_is_refused():
    picture = np.zeros((20, 30), np.uint8)
    with pytest.raises(BadParameter, match="alpha"):
        horn_schunck(picture, picture, alpha=0)
    with pytest.raises(BadParameter, match="shape of the second picture"):
        horn_schunck(picture, picture[:, :-1])
    with pytest.raises(BadParameter, match="grey"):
        horn_schunck(np.zeros((20, 30, 3), np.uint8), np.zeros((20, 30, 3), np.uint8))
    with pytest.raises(BadParameter, match="sweeps"):
        horn_schunck_sweeps(picture, picture, sweeps=0)
    with pytest.raises(BadParameter, match="size"):
        horn_schunck(np.zeros((1, 30)), np.zeros((1, 30)))
