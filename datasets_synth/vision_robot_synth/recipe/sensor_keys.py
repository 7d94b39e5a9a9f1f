"""The keys of [sensor]: the effects of `VideoSensor`."""

from dataclasses import fields

from vision_robot_synth.recipe.kinds import Number, Whole
from vision_robot_synth.recipe.parts import Key
from vision_robot_synth.sensor import VideoSensor

__all__ = ["SENSOR_KEYS"]

LIMITS = {
    "jpeg": Whole(0, 100),
    **dict.fromkeys(("shutter", "vignetting", "flicker", "shade", "dropped"), Number(0, 0.999)),
}

TEXTS = {
    "blur_px": "standard deviation of the optics' blur",
    "defocus_px": "radius of the disc that a point out of focus becomes",
    "shutter": "part of the time between frames in which light is gathered: motion blur",
    "vignetting": "part of the light lost in the corners",
    "exposure_drift": "standard deviation of the logarithm of the exposure",
    "white_balance_drift": "standard deviation of the logarithms of the gains of red and blue",
    "drift_period_s": "period of the fastest part of these drifts",
    "flicker": "depth of the bands that a flickering lamp leaves",
    "flicker_hz": "frequency of its light",
    "readout_s": "time in which a rolling shutter passes over all rows",
    "shade": "part of the light that a wandering soft shade takes away",
    "shade_period_s": "period of the fastest part of its way",
    "shot_noise": "variance of the photons' noise per grey value",
    "read_noise": "standard deviation of the read-out's noise in grey values",
    "jpeg": "quality of a compression, 0 for none",
    "dropped": "probability that a frame does not arrive and repeats the one before",
}

SENSOR_KEYS: dict[str, Key] = {
    one.name: Key(LIMITS.get(one.name, Number(0)), one.default, TEXTS[one.name])
    for one in fields(VideoSensor)
}
