"""A kind of arm whose joints follow from the pose in closed form."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

from vision_robot.arm.closed_form.screws import Screws

__all__ = ["Structure"]


class Structure(ABC):
    """One kind of arm: what its axes must be like, and all its solutions in symbols."""

    name: ClassVar[str]
    pattern: ClassVar[str]
    """P for each joint that slides, R for each that turns."""

    @staticmethod
    @abstractmethod
    def conditions(screws: Screws) -> Sequence[tuple[str, float]]:
        """What the axes must be like, each with how far from it they are [rad or m]."""

    @staticmethod
    @abstractmethod
    def branches(screws: Screws, turn: Any, shift: Any) -> list[list[Any]]:
        """All solutions, each one symbol a joint, for ``E_0(q_0) ... E_n-1(q_n-1) = (turn, shift)``.

        `turn` (3, 3) and `shift` (3,) are the goal times the inverse of the tool's pose at zero.
        """
