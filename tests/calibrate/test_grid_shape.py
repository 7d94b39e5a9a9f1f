"""Directions and bends of a board's edges come back from its corners."""

import numpy as np
import pytest

from tests.chessboard_pictures import BOARD, CAMERA, posed
from vision_robot.calibrate.grid_shape import grid_shape, strays, without_strays

SHAPE = (BOARD.rows, BOARD.columns, 2)


def truth(seed: int = 1) -> np.ndarray:
    return CAMERA.project(posed(seed).apply(BOARD.points)).reshape(SHAPE)


def test_circle_has_its_curvature():
    """Rows on concentric circles of radius 200 … px bend by one over their radius."""
    radius = 200 + 20 * np.arange(6)[:, None]
    angle = -np.pi / 2 + 0.08 * (np.arange(9) - 4)
    grid = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    shape = grid_shape(grid, degree=4)
    expected = np.broadcast_to(1 / radius, (6, 9)).ravel()
    assert np.abs(shape.curvature[:, 0]) == pytest.approx(expected, rel=0.02)
    assert np.abs(shape.curvature[:, 1]).max() < 2e-4
    assert np.linalg.norm(shape.edges[:, 1], axis=1) == pytest.approx(20, rel=2e-3)


def test_edges_and_bends_are_the_projections_own():
    """Against differences of the projected board edges themselves, with lens and perspective."""
    pose, step = posed(1), 0.3 * BOARD.square_m
    shape = grid_shape(truth(), degree=4)
    for axis in range(2):
        move = step * np.eye(3)[axis]
        here, ahead, behind = (CAMERA.project(pose.apply(BOARD.points + m)) for m in (0 * move, move, -move))
        first, second = (ahead - behind) / 2, ahead + behind - 2 * here
        bend = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / np.linalg.norm(first, axis=1) ** 3
        assert np.abs(shape.edges[:, axis] - first / 0.3).max() < 0.15
        # Within 15 px of a corner, a bend of 1e-4 / px is 0.01 px of sag.
        assert np.median(np.abs(shape.curvature[:, axis] - bend)) < 3e-5
        assert np.abs(shape.curvature[:, axis] - bend).max() < 2.5e-4


def test_small_grid_is_straight():
    """Nine corners do not tell bends from noise: a homography must do."""
    grid = np.stack(np.meshgrid(np.arange(3.0), np.arange(3.0)), axis=-1) * 30
    assert np.abs(grid_shape(grid, degree=4).curvature).max() < 1e-9


def test_strays_are_brought_back_and_the_rest_left_alone():
    """One start half a square off returns to its place; the others do not move."""
    grid = truth()
    shaken = grid + np.random.default_rng(0).normal(0, 0.1, SHAPE)
    shaken[2, 3] += (9, -12)
    mended = without_strays(shaken)
    assert np.linalg.norm(mended[2, 3] - grid[2, 3]) < 0.5
    others = np.ones(SHAPE[:2], dtype=bool)
    others[2, 3] = False
    assert np.array_equal(mended[others], shaken[others])


def test_strays_after_refinement():
    """Half a pixel is a stray among corners good to a hundredth, and not among those good to a tenth."""
    noise = np.random.default_rng(0).normal(0, 1, SHAPE)
    for sigma, expected in ((0.01, [23]), (0.1, [])):
        grid = truth() + sigma * noise
        grid[2, 3] = truth()[2, 3] + (0.5, 0)
        assert np.flatnonzero(strays(grid)).tolist() == expected
