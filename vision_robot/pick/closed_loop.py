"""Closed loop (O2): the label on the hand and the thing are seen together, and their error is fed back."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from vision_robot.errors import LostSight, Unreachable
from vision_robot.pick.episode import Look
from vision_robot.pick.hand_label import HandLabel
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.look import Eye
from vision_robot.pick.player import Player
from vision_robot.pick.servo.continuous import image_based, position_based
from vision_robot.pick.servo.hand import Hand
from vision_robot.pick.servo.look_move_look import look_move_look
from vision_robot.pick.servo.settings import Servoing
from vision_robot.pick.servo.stage import Stage
from vision_robot.pick.sighting import Sighting
from vision_robot.track.tracker import Tracker
from vision_robot.types import Array, Float

__all__ = ["LAWS", "ClosedLoop"]

LAWS: dict[str, Callable[[Stage, Sighting, Servoing], Sighting]] = {
    "look-move-look": look_move_look,
    "position": position_based,
    "image": image_based,
}
"""Name -> law."""


@dataclass
class ClosedLoop:
    """An approach that looks at the label until the tool is where it has to be; call it as `Approach`."""

    law: str
    eye: Eye
    tracker: Tracker
    knowledge: Knowledge
    label: HandLabel
    true_tracking: bool = False
    thing: str = ""
    """Name of what is picked: each look is kept with the true error beside it, which nothing here uses."""
    looks: list[Look] = field(default_factory=list)
    how: Servoing = field(default_factory=Servoing)
    seed: int = 0
    """Of which pictures are lost."""

    def __call__(self, player: Player, first: Sighting, above: Float[Array, "n"]) -> tuple[Sighting, int]:
        """Servo above the thing; what comes back is the place to command so that the tool is really there.

        Hand and elbow are held in that way which shows the label best, and in the others if it is hidden all
        the same. Raises LostSight where it is hidden in all.
        """
        del above  # a loop finds its own way there
        player.phase = self.law
        lost: LostSight | Unreachable | None = None
        for hand in self._ways(player, first):
            try:
                return LAWS[self.law](hand, first, self.how), 1 + len(self.looks)
            except (LostSight, Unreachable) as error:
                lost = error if lost is None or isinstance(error, LostSight) else lost
        assert lost is not None
        raise lost

    def _ways(self, player: Player, first: Sighting) -> list[Hand]:
        """All ways to hold hand and elbow, those with more room for the lines of sight first."""
        hand = Hand(
            player,
            self.eye,
            self.tracker,
            self.knowledge,
            self.label,
            self.thing,
            self.true_tracking,
            looks=self.looks,
            chance=np.random.default_rng([self.seed, 3]),
        )
        ways = hand.ways(first, self.how.heights_m[-1])
        return sorted(ways, key=lambda way: -min(_room_m(way, first, h) for h in self.how.heights_m))


def _room_m(hand: Hand, first: Sighting, height_m: float) -> float:
    try:
        return hand.clearance_m(first, height_m)
    except Unreachable:
        return -np.inf
