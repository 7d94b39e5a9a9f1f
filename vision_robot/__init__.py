"""Vision Robot: from camera to grasp, with numbers for how good every step is."""

__version__ = "0.1.0"
