"""The sensor of a video camera, effect by effect; everything is off until it is asked for."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import cv2
import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.types import Array, Float, Image
from vision_robot_synth.sensor.compression import through_jpeg
from vision_robot_synth.sensor.drops import delivered
from vision_robot_synth.sensor.lighting import channel_gains, flicker_rows, shade_field, vignette
from vision_robot_synth.sensor.noise import deviation, standard_normals
from vision_robot_synth.sensor.optics import blurred

__all__ = ["VideoSensor", "mean_of"]


@dataclass(frozen=True)
class VideoSensor:
    """From the light of a render to the picture a camera delivers.

    Grey values stand for light: gains multiply them, shot noise grows with their root. What is
    drawn by chance depends on seed and frame alone, so that frames come out the same in every
    order and on any number of workers. With every effect at 0 the picture is the render, bit
    for bit. The lens is not here: it bends the truth too and belongs to the `Camera`.
    """

    blur_px: float = 0.0
    """Standard deviation of a Gaussian blur of the optics [px]."""
    defocus_px: float = 0.0
    """Radius of the disc that a point becomes out of focus [px]."""
    shutter: float = 0.0
    """Part of the time from frame to frame in which light is gathered; what moves then is blurred."""
    vignetting: float = 0.0
    """Part of the light lost in the picture's corners."""
    exposure_drift: float = 0.0
    """Standard deviation of the logarithm of the exposure."""
    white_balance_drift: float = 0.0
    """Standard deviation of the logarithms of the gains of red and blue against green."""
    drift_period_s: float = 4.0
    """Period of the fastest part of these drifts [s]."""
    flicker: float = 0.0
    """Depth of the bands that a flickering lamp leaves, as a part of the light."""
    flicker_hz: float = 100.0
    """Frequency of the lamp's light [Hz]; twice that of the mains."""
    readout_s: float = 0.02
    """Time in which a rolling shutter passes over all rows [s]."""
    shade: float = 0.0
    """Part of the light that a soft shade takes away as it comes and goes across the picture."""
    shade_period_s: float = 4.0
    """Period of the fastest part of its way [s]."""
    shot_noise: float = 0.0
    """Variance of the photons' noise per grey value [grey values]: one over electrons per grey value."""
    read_noise: float = 0.0
    """Standard deviation of the read-out's noise [grey values]."""
    jpeg: int = 0
    """Quality of 1 to 100 of a compression; 0 is none."""
    dropped: float = 0.0
    """Probability that a frame does not arrive and the last one is handed out again."""

    def __post_init__(self) -> None:
        fractions = ("shutter", "vignetting", "flicker", "shade", "dropped")
        positive = ("drift_period_s", "flicker_hz", "shade_period_s")
        for field in fields(self):
            value = getattr(self, field.name)
            allowed = "a number that is zero or positive"
            good = isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value < np.inf
            if good and field.name in fractions:
                allowed, good = "from 0 to below 1", value < 1
            elif good and field.name in positive:
                allowed, good = "positive", value > 0
            elif field.name == "jpeg":
                allowed = "a whole number from 1 to 100, or 0 for none"
                good = good and value <= 100 and value == int(value)
            if not good:
                raise BadParameter(f"sensor {field.name}", value, allowed)
            object.__setattr__(self, field.name, int(value) if field.name == "jpeg" else float(value))

    def delivered(self, frame: int, seed: int) -> int:
        """The frame whose picture arrives at `frame`: itself, or an earlier one where it was dropped."""
        return delivered(frame, self.dropped, seed)

    def gain(self, size: tuple[int, int], time_s: float, seed: int) -> Float[Array, "h w 3"] | None:
        """Gain of each pixel's blue, green and red at a time; None where all are 1."""
        fields = []
        if self.shade:
            fields.append(shade_field(time_s, size, self.shade, self.shade_period_s, seed))
        if self.flicker:
            rows = flicker_rows(time_s, size[1], self.flicker, self.flicker_hz, self.readout_s, seed)
            fields.append(np.repeat(rows[:, None], size[0], axis=1))
        channels = channel_gains(
            time_s, self.exposure_drift, self.white_balance_drift, self.drift_period_s, seed
        )
        if not fields and (channels == 1).all():
            return vignette(size, self.vignetting) if self.vignetting else None
        gain = vignette(size, self.vignetting)
        for field in fields:
            gain = gain * cv2.cvtColor(field, cv2.COLOR_GRAY2BGR)
        return gain if (channels == 1).all() else gain * channels

    def expose(self, image: Image, frame: int, time_s: float, seed: int = 0) -> Image:
        """The picture as the camera delivers it; `image` itself where no effect is on.

        `image` is blue-green-red or grey; of a grey one the white balance touches nothing.
        """
        light = blurred(image, self.blur_px, self.defocus_px)
        gain = self.gain((image.shape[1], image.shape[0]), time_s, seed)
        if gain is not None:
            if image.ndim == 2:
                gain = gain[..., 1]
            light = cv2.multiply(light, gain, dtype=cv2.CV_32F)
        if self.read_noise or self.shot_noise:
            if light.dtype == np.uint8:
                light = light.astype(np.float32)
            noise = standard_normals(light.shape, seed, frame)
            noise *= deviation(light, self.read_noise, self.shot_noise)
            light = cv2.add(light, noise, dtype=cv2.CV_8U)
        elif light.dtype != np.uint8:
            light = quantised(light)
        return through_jpeg(light, self.jpeg)


def mean_of(exposures: Sequence[Image]) -> Image:
    """Light gathered over several moments of an open shutter."""
    if len(exposures) == 1:
        return exposures[0]
    total = np.zeros(exposures[0].shape, dtype=np.float32)
    for image in exposures:
        cv2.accumulate(image, total)
    return quantised(total * np.float32(1 / len(exposures)))


def quantised(light: Float[Array, "h w *c"]) -> Image:
    """Rounded to 8 bits, and held at 0 and 255."""
    return cv2.addWeighted(light, 1, light, 0, 0, dtype=cv2.CV_8U)
