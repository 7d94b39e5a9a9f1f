"""Proves that flow of many pixels is found, broken at objects' borders, through noise and exposure."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from tests.flow_scenes import Layer, affine, ellipse, noise_texture, rendered, rod
from vision_robot.errors import BadParameter
from vision_robot.flow import (
    FAST,
    FlowSequence,
    FlowSettings,
    estimate_flow,
    flow_error,
    occluded,
    there_and_back,
)
from vision_robot.flow.brightness import exposure_between, noise_sigma

SIZE = (240, 180)
TABLE = noise_texture(SIZE, seed=1)
THING = noise_texture(SIZE, seed=2, contrast=55)


def scene(shift, *, table=(0, 0), zoom=1.0, **trouble):
    centre = (110, 90)
    layers = [
        Layer(TABLE, affine(table, zoom=zoom, about=(120, 90))),
        Layer(THING, affine(shift), ellipse(centre, (40, 28), 20)),
        Layer(255 - THING, affine((-shift[0] / 2, shift[1])), rod((190, 60), 70, 18, 70)),
    ]
    return rendered(layers, SIZE, **{"noise": 1.5, **trouble})


def error_of(pair, settings=None):
    flow = estimate_flow(pair.first, pair.second, settings).flow
    return flow_error(np.moveaxis(flow, 0, -1), pair.flow, pair.visible).endpoint_px


@pytest.mark.parametrize(
    ("shift", "more", "limit"),
    [
        ((0.6, -0.4), {}, 0.12),
        ((4, 2), {}, 0.25),
        ((-9, 5), {"table": (3, -1)}, 0.5),
        ((3, 1), {"zoom": 1.03}, 0.3),
        ((3, 1), {"noise": 8}, 0.6),
        ((3, 1), {"gain": 1.15}, 0.3),
    ],
)
def test_error_and_rivals(shift, more, limit):
    pair = scene(shift, **more)
    ours = error_of(pair)
    assert ours < limit
    rival = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM).calc(
        pair.first, pair.second, np.zeros((*pair.first.shape, 2), np.float32)
    )
    assert ours < 1.1 * flow_error(rival, pair.flow, pair.visible).endpoint_px


def test_bonds_part_what_moves_from_what_stands():
    pair = scene((5, 2))
    assert error_of(pair) < 0.7 * error_of(pair, FlowSettings(break_at=None))


def test_without_allowing_for_exposure_it_fails():
    pair = scene((2, 1), gain=1.15)
    assert error_of(pair) < 0.5 * error_of(pair, FlowSettings(exposure=False))


def test_robust_weights_and_the_fast_form():
    pair = scene((3, 1))
    assert error_of(pair, FlowSettings(robust=8.0)) < 0.3
    fast = estimate_flow(pair.first, pair.second, FAST)
    assert fast.flow.shape == (2, *pair.first.shape)
    assert error_of(pair, FAST) < 0.6


def test_the_distance_is_as_asked():
    pair = scene((3, 1))
    for tolerance in (0.05, 0.01, 0.002):
        assert (
            estimate_flow(pair.first, pair.second, FlowSettings(tolerance_px=tolerance)).distance_px
            <= tolerance
        )


def test_mirrored_pictures_have_mirrored_flow():
    pair = scene((4, 2))
    u, v = estimate_flow(pair.first, pair.second).flow
    mu, mv = estimate_flow(pair.first[:, ::-1], pair.second[:, ::-1]).flow
    assert np.abs(mu[:, ::-1] + u).mean() < 0.05
    assert np.abs(mv[:, ::-1] - v).mean() < 0.05


def test_what_is_hidden_does_not_come_back():
    pair = scene((9, 0))
    forward = estimate_flow(pair.first, pair.second).flow
    backward = estimate_flow(pair.second, pair.first).flow
    hidden = occluded(forward, backward)
    assert hidden[~pair.visible].mean() > 0.6
    assert hidden[pair.visible].mean() < 0.03
    still = np.zeros((2, 20, 30), np.float32)
    assert there_and_back(still, still).max() == 0
    assert np.isinf(there_and_back(still + 25, still - 25)[-1]).all()


def test_a_sequence_compares_with_the_nth_frame_back():
    frames = [
        rendered([Layer(TABLE, affine((0.8 * k, -0.5 * k)))], SIZE, noise=1, seed=k).second for k in range(6)
    ]
    told = FlowSequence(replace(FAST, halvings=0), back=3)
    results = [told.step(frame) for frame in frames]
    assert [result is None for result in results] == [True] * 3 + [False] * 3
    for result in results[3:]:
        assert result is not None
        assert np.median(result.flow[0]) == pytest.approx(2.4, abs=0.05)
        assert np.median(result.flow[1]) == pytest.approx(-1.5, abs=0.05)
    past = FlowSequence(FAST, to_past=True)
    past.step(frames[0])
    back = past.step(frames[1])
    assert back is not None
    assert np.median(back.flow[0]) == pytest.approx(-0.8, abs=0.05)


def test_noise_and_exposure_are_measured():
    clean = noise_texture(SIZE, seed=4, finest_px=4)
    for sigma in (2.0, 8.0):
        noisy = clean + np.random.default_rng(1).normal(0, sigma, clean.shape)
        assert noise_sigma(noisy) == pytest.approx(sigma, rel=0.25)
    second = (clean - 5) / 1.2
    second[40:90, 60:120] = 30  # something else stands there now
    gain, offset = exposure_between(clean, second.astype(np.float32))
    assert gain == pytest.approx(1.2, abs=0.01)
    assert offset == pytest.approx(5, abs=1)
    assert exposure_between(np.full((20, 20), 7.0, np.float32), np.full((20, 20), 9.0, np.float32)) == (
        1.0,
        -2.0,
    )


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"alpha": -1}, "alpha"),
        ({"warps": 0}, "warps"),
        ({"median": 4}, "median"),
        ({"halvings": -1}, "halvings"),
    ],
)
def test_bad_settings_are_refused(wrong, named):
    with pytest.raises(BadParameter, match=named):
        FlowSettings(**wrong)


def test_bad_pictures_are_refused():
    grey = np.zeros((30, 40), np.uint8)
    with pytest.raises(BadParameter, match="grey"):
        estimate_flow(np.zeros((30, 40, 3), np.uint8), np.zeros((30, 40, 3), np.uint8))
    with pytest.raises(BadParameter, match="one size"):
        estimate_flow(grey, grey[1:])
    with pytest.raises(BadParameter, match="back"):
        FlowSequence(back=0)
