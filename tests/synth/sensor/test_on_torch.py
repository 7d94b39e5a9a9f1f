"""The sensor on torch is the sensor on numpy, but for rounding."""

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot_synth.sensor import VideoSensor
from vision_robot_synth.sensor.on_torch import expose_batch

SENSOR = VideoSensor(
    blur_px=0.8,
    defocus_px=1.7,
    vignetting=0.2,
    exposure_drift=0.1,
    white_balance_drift=0.1,
    flicker=0.1,
    shade=0.3,
    shot_noise=0.1,
    read_noise=1.0,
)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_batch_is_the_frames_one_by_one():
    torch = pytest.importorskip("torch")
    rng = np.random.default_rng(0)
    frames = rng.integers(0, 256, (3, 48, 64, 3), dtype=np.uint8)
    images = torch.from_numpy(frames.transpose(0, 3, 1, 2).copy())
    for sensor, allowed in ((SENSOR, 1e-3), (VideoSensor(), 0.0), (VideoSensor(jpeg=70), 0.0)):
        batch = expose_batch(sensor, images, fps=30.0, first_frame=5, seed=2)
        assert batch.dtype == torch.uint8
        for i, image in enumerate(frames):
            alone = sensor.expose(image, 5 + i, (5 + i) / 30, seed=2)
            off = np.abs(batch[i].permute(1, 2, 0).numpy().astype(int) - alone.astype(int))
            assert off.max(initial=0) <= (1 if allowed else 0)
            assert (off > 0).mean() <= allowed
    with pytest.raises(BadParameter, match="images"):
        expose_batch(SENSOR, images.float(), fps=30.0)
