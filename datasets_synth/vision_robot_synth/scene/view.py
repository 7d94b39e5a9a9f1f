"""The camera of a scene: where it stands, what it sees, and how it shakes."""

from dataclasses import dataclass

import numpy as np

from vision_robot.errors import BadParameter, BadRecipe
from vision_robot.geometry import SE3, Camera
from vision_robot.sim.cell_design import StationCamera, look_at
from vision_robot_synth.recipe.parts import CameraPart
from vision_robot_synth.sensor.chance import Purpose, drift

__all__ = ["Shake", "view_of"]


def view_of(part: CameraPart, size: tuple[int, int], recipe: str) -> StationCamera:
    """A camera that looks at the origin of {S}.

    Untilted it looks straight down, +y of {S} to the right and the arm's side on top; tilted it stands on the
    side away from the arm, or at `turn_deg` from there.
    """
    tilt, turn = np.deg2rad(_one(part.tilt_deg)), np.deg2rad(_one(part.turn_deg))
    distance = _one(part.height_mm) / 1e3 / np.cos(tilt)
    width, height = size
    focal = width * distance / (_one(part.field_mm) / 1e3)
    cx, cy = (width - 1) / 2 + part.off_centre * width, (height - 1) / 2 - 0.7 * part.off_centre * width
    try:
        camera = Camera(width, height, focal, focal, cx, cy, model=part.lens, distortion=part.distortion)
    except BadParameter as error:
        raise BadRecipe(recipe, f"camera.distortion: {error}") from error
    outward = np.array([np.cos(turn), np.sin(turn)])
    eye = (*(distance * np.sin(tilt) * outward).tolist(), float(distance * np.cos(tilt)))
    return look_at(camera, eye, (0.0, 0.0, 0.0), up=(-float(outward[0]), -float(outward[1]), 0.0))


@dataclass(frozen=True)
class Shake:
    """A camera that trembles: small random motions of its place and direction."""

    place_m: float
    """Standard deviation of each coordinate."""
    turn_rad: float
    """Standard deviation of the turn about each axis."""
    period_s: float
    seed: int

    def __bool__(self) -> bool:
        return self.place_m > 0 or self.turn_rad > 0

    def cam_from_station(self, still: SE3, time_s: float) -> SE3:
        """The pose of the shaken camera; `still` is that of the camera at rest."""
        if not self:
            return still
        waves = [drift(time_s, self.period_s, self.seed, Purpose.SHAKE, i) for i in range(6)]
        return (
            SE3.from_rotvec(self.turn_rad * np.array(waves[:3]), self.place_m * np.array(waves[3:])) @ still
        )


def _one(value: float | tuple[float, float]) -> float:
    assert not isinstance(value, tuple), "ranges are drawn before they come here"
    return value
