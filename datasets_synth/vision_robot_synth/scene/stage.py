"""A scene in play: the cell brought to the moments that are photographed."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from vision_robot.geometry import plane_from_pixels
from vision_robot.sim.cell import Cell
from vision_robot.sim.gl import load_mujoco
from vision_robot_synth.scene.reach import ArmCourse, course_of
from vision_robot_synth.scene.scene import Scene

__all__ = ["Stage"]

NOT_DRAWN = 5
"""A group of geoms that MuJoCo leaves out of pictures."""
SWAY, FARTHEST_M = 4.0, 5.0
"""A shaking camera's farthest swing in standard deviations; how far away the border it sees can be."""


class Stage:
    """Goes through the moments of a scene that are photographed.

    Where physics moves things it goes forwards only, and through the moments of all frames between, so
    that a frame is the same whatever was asked for before it. `save` and `back` return to a moment
    bit for bit.
    """

    def __init__(self, scene: Scene):
        self.scene, self.cell = scene, Cell(scene.design)
        # Shutters open before a frame's time: the first one's opening is the cell's time 0.
        self._lead_s = scene.sensor.shutter / scene.recipe.video.fps / 2
        self._leave_out_what_nobody_sees()
        self._course = self._planned_course()
        self._time_s, self.next_frame = -self._lead_s, 0
        self._go(self._time_s)

    def moments(self, frame: int) -> Iterator[float]:
        """Bring everything to the moments of a frame's open shutter, one after the other.

        The middle one is the frame's own. Run it to its end before anything else.
        """
        assert frame >= self.next_frame or self.scene.is_planned, "physics goes forwards"
        if not self.scene.is_planned:
            for between in range(self.next_frame, frame):
                for time in self._times(between):
                    self._go(time)
        for time in self._times(frame):
            self._go(time)
            yield time
        self.next_frame = frame + 1

    def _times(self, frame: int) -> list[float]:
        scene = self.scene
        open_s = scene.sensor.shutter / scene.recipe.video.fps
        shares = (np.arange(scene.exposures) + 0.5) / scene.exposures - 0.5
        return (frame / scene.recipe.video.fps + open_s * shares).tolist()

    def save(self) -> Any:
        """This moment, to go `back` to."""
        mj = load_mujoco(rendering=False)
        kind = mj.mjtState.mjSTATE_INTEGRATION.value
        state = np.empty(mj.mj_stateSize(self.cell.model, kind))
        mj.mj_getState(self.cell.model, self.cell.data, state, kind)
        return self.next_frame, self._time_s, state

    def back(self, saved: Any) -> None:
        """Return to a saved moment."""
        mj = load_mujoco(rendering=False)
        self.next_frame, self._time_s, state = saved
        mj.mj_setState(self.cell.model, self.cell.data, state, mj.mjtState.mjSTATE_INTEGRATION.value)

    def _go(self, time_s: float) -> None:
        cell, gone = self.cell, time_s - self._time_s
        if self.scene.is_planned:
            cell.at(time_s + self._lead_s)
        elif gone > 1e-9 and self._course is None:
            cell.advance(gone)
        elif gone > 1e-9 and self._course is not None:
            (before, gap), (after, next_gap) = self._course.at(self._time_s), self._course.at(time_s)
            cell.follow(np.array([0.0, gone]), np.stack([before, after]), np.array([gap, next_gap]))
        self.scene.lamp.shine(cell, time_s)
        self._time_s = time_s

    def _leave_out_what_nobody_sees(self) -> None:
        """Where the table fills the picture the floor below it need not be drawn; a quarter of the time."""
        table, camera = self.scene.design.table, self.scene.view.camera
        u, v = np.arange(-1, camera.width + 1.0), np.arange(-1, camera.height + 1.0)
        border = [(a, b) for a in u for b in v[[0, -1]]] + [(a, b) for a in u[[0, -1]] for b in v]
        places = plane_from_pixels(camera, self.scene.view.cam_from_station, np.array(border))
        sway = SWAY * (self.scene.shake.place_m + self.scene.shake.turn_rad * FARTHEST_M)
        half = np.array(table.size_m) / 2 - sway
        if (np.abs(places - np.array(table.middle_m)) < half).all():  # not so where there is no place
            self.cell.model.geom("floor").group = NOT_DRAWN

    def _planned_course(self) -> ArmCourse | None:
        arm, cell = self.scene.arm, self.cell
        if arm is None:
            return None
        names = [item.name for item in self.scene.design.items]
        name = arm.towards if arm.towards in names else (names[0] if names else "")
        if not name:
            return course_of(cell, "rest", np.zeros(3), 0.0, 1.0, 0.0)
        pose = cell.station_from(name)
        yaw = float(np.arctan2(pose.rotation[1, 0], pose.rotation[0, 0]))
        item = next(item for item in self.scene.design.items if item.name == name)
        speed = arm.speed_mm_s
        assert isinstance(speed, float), "drawn"
        return course_of(cell, arm.task, pose.translation, yaw, speed / 1e3, item.size_m[1])
