"""The light of a scene as it wanders and swings."""

from dataclasses import dataclass

import numpy as np

from vision_robot.sim.cell import Cell
from vision_robot_synth.recipe.parts import LightPart
from vision_robot_synth.sensor.chance import Purpose, drift, generator

__all__ = ["Lamp"]


@dataclass(frozen=True)
class Lamp:
    """The drawn values of [light], and a seed for how it wanders."""

    part: LightPart
    seed: int

    def shine(self, cell: Cell, time_s: float) -> None:
        """Set the lights of a cell to those of a time."""
        part = self.part
        values = [part.drift, part.swing_deg, part.strength, part.ambient, part.azimuth_deg]
        wander, swing, key, ambient, azimuth = (float(value) for value in values)  # type: ignore[arg-type]
        if wander == 0 and swing == 0:
            return
        gain = float(np.exp(wander * drift(time_s, part.drift_period_s, self.seed, Purpose.SCENE, 1)))
        phase = generator(self.seed, Purpose.SCENE, 2).uniform(0, 2 * np.pi)
        turned = azimuth + swing * np.sin(2 * np.pi * time_s / part.swing_period_s + phase)
        cell.set_light(key=gain * key, ambient=gain * ambient, azimuth_rad=float(np.deg2rad(turned)))
