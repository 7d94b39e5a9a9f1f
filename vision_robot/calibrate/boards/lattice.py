"""Ordering points that lie on a lattice, in perspective and through a lens.

A lattice is grown from one point outwards, each step like the last one or those beside it: so neither
straight lines nor a homography is assumed. Which lattice site is which is read off the outline of
what has grown, which must be the board's own.
"""

from collections import deque
from itertools import product

import numpy as np

from vision_robot.types import Array, Bool, Float, Int

__all__ = ["match_lattice"]

Site = tuple[int, int]

STEP_TOLERANCE = 0.4
"""How far a point may lie from where the step leads, as a share of the step."""

MOST_POINTS = 600
"""The smallest points beyond this number are left out: they are noise."""

SEEDS = 5

ALONG = ((1, 0), (-1, 0), (0, 1), (0, -1))
DIAGONAL = ((1, 1), (-1, -1), (1, -1), (-1, 1))

SIZE_TOLERANCE = 2.0
"""Largest ratio of the sizes of neighbours."""

MAPS = [
    np.array([[a, b], [c, d]]) for a, b, c, d in product(range(-2, 3), repeat=4) if abs(a * d - b * c) == 1
]
"""Changes of lattice basis: the growth may have started along a diagonal."""


def match_lattice(
    points: Float[Array, "n 2"], sizes: Float[Array, "n"], sites: Int[Array, "m 2"]
) -> Int[Array, "m"] | None:
    """Which point lies on which of the board's lattice `sites`, or None where the board is not seen.

    `sizes` are the points' own sizes (radii) [px]. Sites turn clockwise from the first axis to the second
    as seen (v down). Where several orders are possible, the one is taken whose first axis points
    most to the right.
    """
    if len(points) < len(sites):
        return None
    largest = np.argsort(-sizes, kind="stable")[: max(MOST_POINTS, 2 * len(sites))]
    points, sizes = points[largest], sizes[largest]
    tried: set[int] = set()
    for seed in _regular_first(points, sizes).tolist():
        if seed in tried:
            continue
        for grown in _grown_from(seed, points, sizes):
            tried.update(grown.values())
            if len(grown) == len(sites):
                match = _matched(grown, points, sites)
                if match is not None:
                    return largest[match]
    return None


def _regular_first(points: Float[Array, "n 2"], sizes: Float[Array, "n"]) -> Int[Array, "s"]:
    """Where to start: points whose nearest neighbours lie opposite one another in pairs."""
    apart = np.linalg.norm(points[:, None] - points, axis=2)
    apart[~_alike(sizes, sizes[:, None])] = np.inf
    np.fill_diagonal(apart, np.inf)
    near = np.argpartition(apart, min(4, len(points) - 1), axis=1)[:, :4]
    opposite = 2 * points[:, None] - points[near]
    gap = np.linalg.norm(opposite[:, :, None] - points, axis=3).min(axis=2)
    step = np.take_along_axis(apart, near, axis=1)
    paired = (gap < STEP_TOLERANCE * step).sum(axis=1)
    return np.argsort(-paired, kind="stable")[:SEEDS]


def _grown_from(seed: int, points: Float[Array, "n 2"], sizes: Float[Array, "n"]) -> list[dict[Site, int]]:
    """Lattices grown from a point along its nearest neighbours, the largest first."""
    away = points - points[seed]
    distance = np.linalg.norm(away, axis=1)
    alike = _alike(sizes, float(sizes[seed]))
    alike[seed] = False
    near = np.flatnonzero(alike)[np.argsort(distance[alike], kind="stable")[:8]]
    grown = []
    for first, second in ((i, j) for k, i in enumerate(near[:4]) for j in near[k + 1 :]):
        a, b = away[first], away[second]
        sine = (a[0] * b[1] - a[1] * b[0]) / (distance[first] * distance[second])
        if abs(sine) < 0.3 or distance[second] > 4 * distance[first]:
            continue
        lattice = _grow(seed, a, b, points, sizes)
        grown.append(lattice)
        if len(lattice) >= 9:
            break
    return sorted(grown, key=len, reverse=True)


def _grow(
    seed: int,
    a: Float[Array, "2"],
    b: Float[Array, "2"],
    points: Float[Array, "n 2"],
    sizes: Float[Array, "n"],
) -> dict[Site, int]:
    placed: dict[Site, int] = {(0, 0): seed}
    used = np.zeros(len(points), dtype=bool)
    used[seed] = True
    steps = {(0, 0): np.stack([a, b])}
    queue, beyond = deque([((0, 0), ALONG)]), [(0, 0)]
    while queue:
        site, moves = queue.popleft()
        here = points[placed[site]]
        for i, j in moves:
            there = (site[0] + i, site[1] + j)
            if there in placed:
                continue
            step = _step_beside(site, (i, j), placed, points)
            step = np.array([i, j]) @ steps[site] if step is None else step
            distance = np.linalg.norm(points - (here + step), axis=1)
            distance[used | ~_alike(sizes, float(sizes[placed[site]]))] = np.inf
            best = int(np.argmin(distance))
            shortest = np.linalg.norm(step) if moves is ALONG else np.linalg.norm(steps[site], axis=1).min()
            if distance[best] > STEP_TOLERANCE * shortest:
                continue
            placed[there], used[best] = best, True
            steps[there] = steps[site].copy()
            if moves is ALONG:
                steps[there][0 if i else 1] = (points[best] - here) * (i + j)
            queue.append((there, ALONG))
            beyond.append(there)
        if not queue:
            # Corners of a board may hang on by a diagonal alone.
            queue.extend((site, DIAGONAL) for site in beyond)
            beyond = []
    return placed


def _step_beside(
    site: Site, move: tuple[int, int], placed: dict[Site, int], points: Float[Array, "n 2"]
) -> Float[Array, "2"] | None:
    """The same step in the lines to both sides, where it has been made: it tells more than the last one."""
    (x, y), (i, j) = site, move
    beside = [(x - j, y + i), (x + j, y - i)]
    pairs = [(s, (s[0] + i, s[1] + j)) for s in beside]
    known = [points[placed[e]] - points[placed[s]] for s, e in pairs if s in placed and e in placed]
    return np.mean(known, axis=0) if known else None


def _alike(sizes: Float[Array, "n"], size: float | Float[Array, "n 1"]) -> Bool[Array, "*m n"]:
    return (sizes < SIZE_TOLERANCE * size) & (sizes > size / SIZE_TOLERANCE)


def _matched(
    grown: dict[Site, int], points: Float[Array, "n 2"], sites: Int[Array, "m 2"]
) -> Int[Array, "m"] | None:
    """The order under which the grown lattice has exactly the board's sites."""
    places, members = np.array(list(grown)), np.array(list(grown.values()))
    wanted = sites - sites.min(axis=0)
    rank = np.lexsort(wanted.T)
    best, best_right = None, -np.inf
    for change in MAPS:
        moved = places @ change.T
        moved -= moved.min(axis=0)
        found = np.lexsort(moved.T)
        if not (moved[found] == wanted[rank]).all():
            continue
        match = np.empty(len(sites), dtype=int)
        match[rank] = members[found]
        # Mean derivatives of the pixels along the two axes of the board.
        centred = wanted - wanted.mean(axis=0)
        axes = np.linalg.lstsq(centred, points[match] - points[match].mean(axis=0), rcond=None)[0]
        right = axes[0, 0] / np.linalg.norm(axes[0])
        if np.linalg.det(axes) > 0 and right > best_right:
            best, best_right = match, right
    return best
