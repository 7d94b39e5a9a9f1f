"""The running median is numpy's, bit for bit, whatever comes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.errors import BadParameter
from vision_robot.track.running_median import BLOCK, RunningMedian


def frames(kind: str, count: int, size: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    base = rng.integers(0, 256, size)
    series = {
        "still": base + rng.normal(0, 2, (count, size)),
        "loud": rng.integers(0, 256, (count, size)),
        "drifting": base + 0.7 * np.arange(count)[:, None] + rng.normal(0, 1, (count, size)),
        "jumping": base + 90 * (np.arange(count)[:, None] > count // 2) * rng.choice([-1, 1], size),
        "white": np.full((count, size), 255) - rng.integers(0, 2, (count, size)),
        "black": rng.integers(0, 2, (count, size)) * np.ones((count, size)),
    }
    return np.clip(series[kind], 0, 255).astype(np.uint8)


@pytest.mark.parametrize("kind", ["still", "loud", "drifting", "jumping", "white", "black"])
def test_it_is_numpys_median(kind):
    window, series = 11, frames(kind, 60, 700)
    running = RunningMedian(700, window)
    for i, frame in enumerate(series):
        running.push(frame)
        seen = series[max(0, i + 1 - window) : i + 1]
        if len(seen) % 2:
            assert np.array_equal(running.median, np.median(seen, axis=0))
        else:
            assert np.array_equal(running.median, np.sort(seen, axis=0)[len(seen) // 2 - 1])
        assert running.count == len(seen)


@given(st.integers(0, 1000), st.sampled_from([3, 5, 9]), st.integers(1, 25))
def test_any_few_levels_and_any_window(seed, window, count):
    rng = np.random.default_rng(seed)
    series = rng.choice(rng.integers(0, 256, 4), (count, 40)).astype(np.uint8)
    running = RunningMedian(40, window)
    for frame in series:
        running.push(frame)
    seen = series[-window:]
    if len(seen) % 2:
        assert np.array_equal(running.median, np.median(seen, axis=0))


def test_blocks_do_not_show():
    series = frames("still", 9, BLOCK + 77)
    out = np.empty(BLOCK + 77, np.uint8)
    running = RunningMedian(BLOCK + 77, 5, out)
    for frame in series:
        running.push(frame)
    assert np.array_equal(out, np.median(series[-5:], axis=0))


def test_some_pixels_forget():
    series = frames("still", 12, 50)
    running = RunningMedian(50, 5)
    for frame in series[:8]:
        running.push(frame)
    running.restart(np.array([3, 9]), np.array([7, 200], np.uint8))
    assert running.median[[3, 9]].tolist() == [7, 200]
    for frame in series[8:10]:
        running.push(frame)
    assert running.median[[3, 9]].tolist() == [7, 200]
    running.push(series[10])
    others = np.setdiff1d(np.arange(50), [3, 9])
    assert np.array_equal(running.median[others], np.median(series[6:11], axis=0)[others])
    forgotten = np.median([[7, 200], [7, 200], *series[8:11, [3, 9]]], axis=0)
    assert np.array_equal(running.median[[3, 9]], forgotten)


@pytest.mark.parametrize("window", [1, 2, 50, 257])
def test_a_window_must_have_a_middle(window):
    with pytest.raises(BadParameter, match="odd number"):
        RunningMedian(5, window)
