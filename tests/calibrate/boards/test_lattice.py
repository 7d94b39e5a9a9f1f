"""Lattices are ordered from points alone: in perspective, among clutter, from any start."""

import numpy as np
import pytest

from vision_robot.calibrate.boards.lattice import match_lattice

SITES = np.stack(np.meshgrid(np.arange(7), np.arange(5)), axis=-1).reshape(-1, 2)


def slanted(sites: np.ndarray) -> np.ndarray:
    """A strong perspective with the x axis to the right."""
    H = np.array([[40.0, 12.0, 100.0], [3.0, 30.0, 80.0], [0.03, 0.04, 1.0]])
    p = np.column_stack([sites, np.ones(len(sites))]) @ H.T
    return p[:, :2] / p[:, 2:]


@pytest.mark.parametrize("seed", range(5))
def test_shuffled_points_among_clutter(seed):
    """Every site gets its own point; clutter of like size does not disturb."""
    rng = np.random.default_rng(seed)
    points = np.concatenate([slanted(SITES), rng.uniform(600, 1200, (40, 2))])
    order = rng.permutation(len(points))
    match = match_lattice(points[order], rng.uniform(4, 5, len(points)), SITES)
    assert match is not None
    np.testing.assert_array_equal(points[order][match], slanted(SITES))


def test_sheared_lattice():
    """When a diagonal is the shortest step the growth starts along it and still finds the order."""
    points = SITES @ np.array([[30.0, 0.0], [-22.0, 8.0]]) + 200
    match = match_lattice(points, np.full(len(points), 3.0), SITES)
    assert match is not None
    np.testing.assert_array_equal(match, np.arange(len(SITES)))


def test_incomplete_or_larger_lattices_are_refused():
    """A missing point, a column more: no board."""
    points, sizes = slanted(SITES), np.full(len(SITES), 4.0)
    assert match_lattice(points[1:], sizes[1:], SITES) is None
    assert match_lattice(points, sizes, SITES[SITES[:, 0] < 6]) is None
