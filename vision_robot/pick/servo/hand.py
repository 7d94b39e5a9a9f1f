"""The hand of a cell as the laws see it: moved by the player, looked at by the cell's camera."""

from dataclasses import dataclass, field, replace

import numpy as np

from vision_robot.arm import base_from_tool
from vision_robot.errors import NothingSeen
from vision_robot.geometry import SE3, WorkPlane
from vision_robot.pick.episode import Look
from vision_robot.pick.goal import joints_for, station_from_grasp, upright
from vision_robot.pick.hand_label import LABEL_SIGMA_PX, HandLabel, seen_whole
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.look import Eye
from vision_robot.pick.player import Player
from vision_robot.pick.servo.clear_sight import clearance_m, skeleton
from vision_robot.pick.servo.patience import LABEL_ON_HAND
from vision_robot.pick.servo.stage import Glimpse
from vision_robot.pick.sighting import Sighting
from vision_robot.sim.cell_model import LABEL
from vision_robot.track.tracker import Tracker
from vision_robot.types import Array, Float

__all__ = ["Hand"]

SHARE = 0.6
"""Of the full speed, on the way to a look."""


@dataclass
class Hand:
    """A `Stage` in MuJoCo. Truth is used in `note` alone, for the record."""

    player: Player
    eye: Eye
    tracker: Tracker
    knowledge: Knowledge
    label: HandLabel
    thing: str = ""
    """Name of what is picked: each look is kept with the true error beside it."""
    true_tracking: bool = False
    turned: bool = False
    """The other way round than the yaw of the thing would have it: fingers are alike."""
    bent: Float[Array, "n"] | None = None
    """Joint values on whose side the elbow is held; None: as it is held now."""
    looks: list[Look] = field(default_factory=list)
    chance: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))
    """By which pictures are lost."""

    @property
    def plane(self) -> WorkPlane:
        """The camera as it is believed to stand."""
        return self.knowledge.plane

    @property
    def time_s(self) -> float:
        """Simulated."""
        return self.player.cell.time_s

    @property
    def period_s(self) -> float:
        """Of the camera."""
        return 1 / self.player.world.frame_rate

    @property
    def latency_s(self) -> float:
        """Of the pictures."""
        return self.player.world.latency_s

    def go(self, place: Sighting, height_m: float) -> None:
        """In joint space, then still."""
        self.player.move_to(self.joints(place, height_m), share=SHARE)

    def step(self, place: Sighting, height_m: float) -> None:
        """The servos are sent there for a picture's period."""
        self.player.servo(self.joints(place, height_m), self.period_s)

    def wait(self, seconds: float) -> None:
        """Stand still."""
        if seconds > 0:
            self.player.hold(seconds)

    def look(self) -> Glimpse:
        """The label in a picture of this moment; raises NothingSeen where it is not seen whole."""
        label = self.label.station_from_label(self.knowledge, self.player.joints)
        if self.chance.random() < self.player.world.lost_sight:
            raise NothingSeen(self.tracker.name, LABEL_ON_HAND)
        if self.true_tracking:
            pixel, sigma = self.eye.truth_of(LABEL).centroid_px, 1e-3
        else:
            corners = self.label.corners_px(self.knowledge, self.player.joints)
            seen = seen_whole(self.tracker.step(self.eye.picture(), self.eye.time_s), corners)
            if seen is None:
                raise NothingSeen(self.tracker.name, f"the whole of {LABEL_ON_HAND}")
            pixel, sigma = seen, LABEL_SIGMA_PX
        return Glimpse(self.time_s, pixel, label.translation, sigma)

    def note(self, error_m: float, sigma_m: float = np.nan) -> None:
        """Keep what was seen, and beside it how far the label really is off."""
        cell, off = self.player.cell, np.nan
        if self.thing:
            apart = cell.station_from(self.thing).translation - cell.station_from(LABEL).translation
            off = float(np.linalg.norm(apart[:2]))
        height = float(self.label.station_from_tool(self.knowledge, self.player.joints).translation[2])
        self.looks.append(Look(self.time_s, error_m, height, off, sigma_m))

    def joints(self, place: Sighting, height_m: float) -> Float[Array, "n"]:
        """Joint values that bring the believed label over `place`, this way round."""
        goal = self._goal(place, height_m)
        return joints_for(
            self.player.solver,
            self.knowledge.base_from_station,
            goal,
            self.player.joints if self.bent is None else self.bent,
            back_towards_m=goal.translation[:2] - goal.rotation[:2, 1],
        )

    def ways(self, place: Sighting, height_m: float) -> list["Hand"]:
        """Both ways round, with each bend of the arm that reaches there."""
        found = []
        for way in (replace(self, turned=False), replace(self, turned=True)):
            goal = upright(base_from_tool(self.knowledge.base_from_station, way._goal(place, height_m)))
            bends = self.player.solver.branches(SE3(goal.rotation[None], goal.translation[None])).of_goal(0)
            # An arm that was measured to be off its drawing may reach no pose upright exactly.
            found += [replace(way, bent=bend) for bend in bends] or [way]
        return found

    def _goal(self, place: Sighting, height_m: float) -> SE3:
        """station_from_tool with the label over `place`."""
        yaw = place.yaw_rad + (np.pi if self.turned else 0.0)
        turn = station_from_grasp(place.position_m, yaw, 0.0).rotation
        beside = place.position_m - (turn @ self.label.tool_from_label.translation)[:2]
        return station_from_grasp(beside, yaw, place.height_m + height_m)

    def clearance_m(self, place: Sighting, height_m: float) -> float:
        """How much room the lines of sight to the label have there."""
        joints, chain = self.joints(place, height_m), self.knowledge.arm.chain
        bones = self.knowledge.base_from_station.inverse().apply(skeleton(chain, joints))
        return clearance_m(self.plane, bones, self.label.corners_in_station(self.knowledge, joints))
