"""What a camera does to the light: optics, lighting, noise, compression, dropped frames."""

from vision_robot_synth.sensor.still import Sensor
from vision_robot_synth.sensor.video import VideoSensor, mean_of

__all__ = ["Sensor", "VideoSensor", "mean_of"]
