"""Who watches an episode from beside: told when it begins and ends, never asked."""

from typing import Protocol

from vision_robot.pick.episode import Episode
from vision_robot.pick.knowledge import Knowledge
from vision_robot.pick.look import Eye
from vision_robot.pick.player import Player
from vision_robot.pick.sighting import Sighting
from vision_robot.sim.cell import Cell

__all__ = ["Witness"]


class Witness(Protocol):
    """What `run_episode` tells; a witness reads and moves nothing."""

    def begins(
        self, cell: Cell, eye: Eye, player: Player, believed: Knowledge, where: Sighting, episode: Episode
    ) -> None:
        """The thing was seen at `where`; the arm has not moved yet."""
        ...

    def unseen(self, cell: Cell, eye: Eye) -> None:
        """The tracker said nothing, and nothing is done."""
        ...

    def ends(self, episode: Episode) -> None:
        """All is at rest."""
        ...
