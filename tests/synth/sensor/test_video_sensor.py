"""The video sensor: off is off bit for bit, each effect is what it says, and order does not matter."""

from dataclasses import fields

import cv2
import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot_synth.sensor import VideoSensor, mean_of

SIZE = (160, 120)
FLAT = np.full((120, 160, 3), 100, dtype=np.uint8)
RNG = np.random.default_rng(0)
SCENE = cv2.GaussianBlur(RNG.integers(0, 256, (120, 160, 3), dtype=np.uint8), (0, 0), 2)
EFFECTS = {
    "blur_px": 1.0,
    "defocus_px": 2.0,
    "vignetting": 0.3,
    "exposure_drift": 0.2,
    "white_balance_drift": 0.2,
    "flicker": 0.2,
    "shade": 0.5,
    "shot_noise": 0.5,
    "read_noise": 3.0,
    "jpeg": 60,
}


def test_with_everything_off_the_picture_is_the_render_itself():
    assert VideoSensor().expose(SCENE, 3, 0.1, seed=5) is SCENE


@pytest.mark.parametrize("effect", EFFECTS)
def test_each_effect_changes_the_picture_alone_and_not_when_off(effect):
    on = VideoSensor(**{effect: EFFECTS[effect]}).expose(SCENE, 3, 0.1, seed=5)
    assert on.shape == SCENE.shape
    assert on.dtype == np.uint8
    assert (on != SCENE).any()
    # Its companions (periods, frequencies) do nothing by themselves.
    others = VideoSensor(drift_period_s=1, flicker_hz=50, readout_s=0.01, shade_period_s=1)
    assert others.expose(SCENE, 3, 0.1, seed=5) is SCENE


def test_frames_are_the_same_in_every_order_and_differ_between_frames_and_seeds():
    sensor = VideoSensor(**EFFECTS)
    forwards = [sensor.expose(SCENE, i, i / 30, seed=1) for i in range(4)]
    backwards = [sensor.expose(SCENE, i, i / 30, seed=1) for i in reversed(range(4))][::-1]
    assert all((a == b).all() for a, b in zip(forwards, backwards, strict=True))
    assert (forwards[0] != forwards[1]).any()
    assert (sensor.expose(SCENE, 0, 0.0, seed=2) != forwards[0]).any()


def test_noise_has_the_variance_it_says_and_is_white():
    for level in (20, 100, 200):
        flat = np.full((200, 200, 3), level, dtype=np.uint8)
        noisy = VideoSensor(read_noise=2.0, shot_noise=0.1).expose(flat, 0, 0.0).astype(float)
        expected = np.sqrt(2.0**2 + 0.1 * level + 1 / 12)
        assert abs(noisy.std() / expected - 1) < 0.02
        assert abs(noisy.mean() - level) < 0.05
        beside = np.corrcoef(noisy[:, 1:].ravel(), noisy[:, :-1].ravel())[0, 1]
        channels = np.corrcoef(noisy[..., 0].ravel(), noisy[..., 1].ravel())[0, 1]
        assert max(abs(beside), abs(channels)) < 0.01


def test_noise_is_gaussian():
    flat = np.full((400, 400), 128, dtype=np.uint8)
    z = (VideoSensor(read_noise=10.0).expose(flat, 0, 0.0).astype(float) - 128) / 10
    assert abs((z**3).mean()) < 0.02
    assert abs((z**4).mean() - 3) < 0.06
    assert abs((np.abs(z) > 2.95).mean() - 0.0032) < 0.0008


def test_blur_of_a_point_has_the_moments_of_its_kernel():
    point = np.zeros((61, 61), dtype=np.uint8)
    point[30, 30] = 255
    u = np.arange(61) - 30.0
    for sensor, variance in ((VideoSensor(blur_px=1.5), 1.5**2), (VideoSensor(defocus_px=4.0), 4.0**2 / 4)):
        # A dim point loses its wings to rounding: spread many of them.
        rows = sensor.expose(np.maximum(point, point[30][None]).astype(np.uint8), 0, 0.0)[30].astype(float)
        assert abs((rows * u).sum()) < 1e-9
        assert abs((rows * u**2).sum() / rows.sum() / variance - 1) < 0.05


def test_vignetting_leaves_the_middle_and_takes_its_part_from_the_corners():
    dark = VideoSensor(vignetting=0.4).expose(np.full((121, 161, 3), 200, dtype=np.uint8), 0, 0.0)
    assert dark[60, 80, 0] == 200
    assert all(abs(int(dark[v, u, 1]) - 120) <= 1 for v in (0, -1) for u in (0, -1))
    assert (np.diff(dark[60, 80:, 2].astype(int)) <= 0).all()


def test_drifts_have_the_deviation_they_say():
    sensor = VideoSensor(exposure_drift=0.1, white_balance_drift=0.05, drift_period_s=1.0)
    logs = []
    for seed in range(40):
        gains = [sensor.gain(SIZE, time, seed) for time in np.linspace(0, 20, 25)]
        logs += [np.log(gain[0, 0]) for gain in gains if gain is not None]
    blue, green, red = np.array(logs).T
    assert abs(green.std() / 0.1 - 1) < 0.15
    assert abs((red - green).std() / 0.05 - 1) < 0.15
    assert abs((blue - green).std() / 0.05 - 1) < 0.15
    assert abs(np.corrcoef(blue - green, red - green)[0, 1]) < 0.2


def test_flicker_moves_from_frame_to_frame_as_the_lamp_and_the_shutter_say():
    sensor = VideoSensor(flicker=0.5, flicker_hz=100.0, readout_s=0.02)
    first, later = (sensor.gain((8, 200), time, 0) for time in (0.0, 0.0025))
    assert first is not None
    assert later is not None
    # Two periods over the rows; a quarter of a period later the bands have moved up by 25 rows.
    assert np.allclose(first[:100], first[100:], atol=1e-4)
    assert np.allclose(first[25:], later[:-25], atol=1e-4)


def test_shade_takes_up_to_its_part_and_comes_and_goes():
    sensor = VideoSensor(shade=0.5, shade_period_s=1.0)
    fields = [sensor.gain(SIZE, time, 3) for time in np.linspace(0, 10, 60)]
    gains = np.array([field[..., 1] for field in fields if field is not None])
    assert (gains >= 0.5).all()
    assert (gains < 1).all()
    assert gains.max() > 0.9
    assert gains.min() < 0.6


def test_white_balance_leaves_grey_pictures_alone():
    grey = FLAT[..., 0]
    assert (VideoSensor(white_balance_drift=0.3).expose(grey, 0, 1.0) == grey).all()
    assert (VideoSensor(exposure_drift=0.3).expose(grey, 0, 1.0) != grey).any()


def test_light_saturates_and_never_wraps():
    bright = np.full((20, 20, 3), 250, dtype=np.uint8)
    dark = np.full((20, 20, 3), 3, dtype=np.uint8)
    assert VideoSensor(read_noise=20).expose(bright, 0, 0.0).min() > 100
    assert VideoSensor(read_noise=20).expose(dark, 0, 0.0).max() < 150


def test_dropped_frames_repeat_the_last_that_arrived():
    sensor = VideoSensor(dropped=0.4)
    given = [sensor.delivered(i, 7) for i in range(400)]
    assert given[0] == 0
    assert all(given[i] == i or given[i] == given[i - 1] for i in range(1, 400))
    share = np.mean([given[i] != i for i in range(400)])
    assert 0.33 < share < 0.47
    assert [VideoSensor().delivered(i, 7) for i in range(5)] == list(range(5))


def test_the_mean_of_exposures_is_their_light():
    a, b = np.full((4, 4, 3), 10, np.uint8), np.full((4, 4, 3), 40, np.uint8)
    assert (mean_of([a, b, b]) == 30).all()
    assert mean_of([a]) is a


@pytest.mark.parametrize("name", [field.name for field in fields(VideoSensor)])
@pytest.mark.parametrize("value", [-1, np.nan, np.inf, "much", None])
def test_impossible_values_are_refused_by_name(name, value):
    with pytest.raises(BadParameter, match=name):
        VideoSensor(**{name: value})


@pytest.mark.parametrize("options", [{"jpeg": 101}, {"jpeg": 50.5}, {"shutter": 1.0}, {"drift_period_s": 0}])
def test_what_is_out_of_range_is_refused(options):
    with pytest.raises(BadParameter):
        VideoSensor(**options)
