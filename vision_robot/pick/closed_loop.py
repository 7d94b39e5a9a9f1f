"""Closed loop (O2): the label on the hand and the thing are seen together, and their error is fed back."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from vision_robot.errors import NothingSeen
from vision_robot.pick.episode import Look
from vision_robot.pick.goal import joints_for, station_from_grasp
from vision_robot.pick.hand_label import HandLabel, largest
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.look import Eye
from vision_robot.pick.player import Player
from vision_robot.pick.servoing import image_step, position_step
from vision_robot.pick.sighting import PIXEL_SIGMA, Sighting
from vision_robot.sim.cell_model import LABEL
from vision_robot.track.tracker import Tracker
from vision_robot.types import Array, Float

__all__ = ["LAWS", "ClosedLoop"]

LOOK_M = (0.15, 0.02)
"""Heights over the thing at which look-move-look looks."""

SURE = 2.0
"""Standard deviations of one look within which an error is no longer known to be one."""

MOST_ROUNDS = 4

WHOLE = 0.8
"""Share of its expected area from which the label counts as seen whole."""

GAIN_PER_S = 2.5
"""Of the continuous laws: the error falls to 1/e in 0.4 s, slow enough for a tenth of a second of latency."""

MOST_SECONDS, STILL_M, STILL_FRAMES = 4.0, 2e-4, 5


@dataclass
class ClosedLoop:
    """An approach that looks at the label until it is where it has to be; call it as `Approach`."""

    law: str
    eye: Eye
    tracker: Tracker
    knowledge: Knowledge
    label: HandLabel
    true_tracking: bool = False
    thing: str = ""
    """Name of what is picked: each look is kept with the true error beside it, which nothing here uses."""
    looks: list[Look] = field(default_factory=list)

    def __call__(self, player: Player, first: Sighting, above: Float[Array, "n"]) -> tuple[Sighting, int]:
        """Servo above the thing; what comes back is the place to command so that the tool is really there.

        Where the label cannot be seen whole either way round, nothing is known better than at first.
        """
        player.phase = self.law
        # What of the arm is higher than the label leans away from the camera's foot in the picture: on the
        # side towards it the label is in sight.
        foot = self.knowledge.plane.cam_from_station.inverse().translation[:2]
        for towards in (foot, 2 * first.position_m - foot):
            self.go(player, first, LOOK_M[0], towards_m=towards)
            try:
                self.look(player)
                return LAWS[self.law](self, player, first), 1 + len(self.looks)
            except NothingSeen:
                self.looks.clear()
        player.move_to(above)
        return first, 1

    def go(
        self, player: Player, target: Sighting, height_m: float, *, towards_m: Float[Array, "2"] | None = None
    ) -> None:
        """Move the believed tool to `height_m` over the thing's axis at `target`."""
        player.move_to(self.joints(player, target, height_m, towards_m=towards_m), share=0.6)

    def joints(
        self, player: Player, target: Sighting, height_m: float, *, towards_m: Float[Array, "2"] | None = None
    ) -> Float[Array, "n"]:
        """Joint values that bring the believed tool there."""
        goal = station_from_grasp(target.position_m, target.yaw_rad, target.height_m + height_m)
        station = self.knowledge.base_from_station
        return joints_for(player.solver, station, goal, player.joints, back_towards_m=towards_m)

    def look(self, player: Player) -> Float[Array, "2"]:
        """Centroid of the label in a picture of this moment [px]; raises NothingSeen where it is hidden."""
        if self.true_tracking:
            return self.eye.truth_of(LABEL).centroid_px
        found = self.tracker.step(self.eye.picture(), self.eye.time_s)
        centroid, area = largest(found, self.tracker.name)
        if area < WHOLE * self.label.expected_area_px(self.knowledge, player.joints):
            raise NothingSeen(self.tracker.name, "the whole label on the hand")
        return centroid

    def note(self, player: Player, error: Float[Array, "2"]) -> float:
        """Keep an error for the picture of how it converged, and return its size [m]."""
        size, cell = float(np.linalg.norm(error)), player.cell
        tool = self.knowledge.arm.chain.base_from_tool(player.joints)
        height = float((self.knowledge.base_from_station.inverse() @ tool).translation[2])
        off = np.nan
        if self.thing:
            off = float(
                np.linalg.norm(
                    (cell.station_from(self.thing).translation - cell.station_from_tool.translation)[:2]
                )
            )
        player.remark = f"look {len(self.looks) + 1} asked for {1000 * size:.1f} mm"
        self.looks.append(Look(cell.time_s, size, height, off))
        return size


def look_move_look(loop: ClosedLoop, player: Player, first: Sighting) -> Sighting:
    """Stand, look, take the whole Newton step, until the error is within what one look can tell.

    The label is seen higher up than the thing, and a camera that was knocked errs differently there. At
    both heights of `LOOK_M` the step is taken; errors of a camera's pose grow evenly with height, so
    the two corrections together tell the one at the thing.
    """
    corrections = []
    for height in LOOK_M:
        target = first
        for _ in range(MOST_ROUNDS):
            loop.go(player, target, height)
            player.hold(player.world.latency_s)
            seen = loop.label.seen_tool(loop.knowledge, player.joints, loop.look(player))
            error = position_step(seen.position_m, first.position_m)
            target = replace(target, position_m=target.position_m + error)
            if loop.note(player, error) < SURE * _pixel_m(loop):
                break
        corrections.append(target.position_m - first.position_m)
    # The label is that much higher over the thing's axis than the tool.
    high, low = (height - float(loop.label.tool_from_label.translation[2]) for height in LOOK_M)
    at_thing = corrections[1] + (corrections[1] - corrections[0]) * low / (high - low)
    return replace(first, position_m=first.position_m + at_thing)


def _pixel_m(loop: ClosedLoop) -> float:
    """What a pixel's noise is worth on the table [m]."""
    camera = loop.knowledge.plane.camera
    distance = float(np.linalg.norm(loop.knowledge.plane.cam_from_station.translation))
    return PIXEL_SIGMA * distance / min(camera.fx, camera.fy)


def position_based(loop: ClosedLoop, player: Player, first: Sighting) -> Sighting:
    """Every frame a step along the error in {S}, both places by the same camera."""

    def step(pixel: Float[Array, "2"], joints: Float[Array, "n"]) -> Float[Array, "2"]:
        seen = loop.label.seen_tool(loop.knowledge, joints, pixel)
        return position_step(seen.position_m, first.position_m)

    return _continuous(loop, player, first, step)


def image_based(loop: ClosedLoop, player: Player, first: Sighting) -> Sighting:
    """Every frame a step that brings the label's image to where it has to be."""
    plane = loop.knowledge.plane

    def step(pixel: Float[Array, "2"], joints: Float[Array, "n"]) -> Float[Array, "2"]:
        wanted = loop.label.wanted_px(loop.knowledge, joints, first.position_m)
        label = loop.label.station_from_label(loop.knowledge, joints)
        return image_step(plane.camera, plane.cam_from_station, label.translation, pixel, wanted)

    return _continuous(loop, player, first, step)


Step = Callable[[Array, Array], Array]
"""(pixel of the label (2,), joint values then (n,)) -> step in the plane of {S} (2,) [m]."""


def _continuous(loop: ClosedLoop, player: Player, first: Sighting, step: Step) -> Sighting:
    """Frames at the camera's rate, answered `latency_s` late; stops when the error stays small."""
    world, target, still = player.world, first, 0
    height, period = LOOK_M[1], 1 / world.frame_rate
    loop.go(player, first, height)
    on_the_way: deque[tuple[float, Array, Array]] = deque()
    end = player.cell.time_s + MOST_SECONDS
    while player.cell.time_s < end and still < STILL_FRAMES:
        on_the_way.append((player.cell.time_s, loop.look(player), player.joints))
        error = None
        while on_the_way and on_the_way[0][0] <= player.cell.time_s - world.latency_s + 1e-9:
            _, pixel, joints = on_the_way.popleft()
            error = step(pixel, joints)
        if error is not None:
            still = still + 1 if loop.note(player, error) < STILL_M else 0
            target = replace(target, position_m=target.position_m + GAIN_PER_S * period * error)
        player.servo(loop.joints(player, target, height), period)
    player.hold(0.2)
    return target


LAWS: dict[str, Callable[[ClosedLoop, Player, Sighting], Sighting]] = {
    "look-move-look": look_move_look,
    "position": position_based,
    "image": image_based,
}
"""Name -> law."""
