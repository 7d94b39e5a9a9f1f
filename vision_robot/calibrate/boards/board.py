"""What every calibration target knows about itself."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Self

from vision_robot.calibrate.boards.drawing import Drawing
from vision_robot.calibrate.corners import Corners
from vision_robot.types import Array, Float, Image

__all__ = ["Board"]


@dataclass(frozen=True)
class Board(ABC):
    """A flat target whose points are known and can be told apart.

    Board frame: x right along the columns and y down along the rows as the printed page is
    read, z into the board (away from a viewer), so that it is right-handed like a camera's;
    z = 0 is the printed face and the origin is point 0. Lengths in metres.
    """

    name: ClassVar[str]
    """Name in the registry and on the command line."""

    allows_partial_views: ClassVar[bool] = False
    """Whether points carry their own identity, so that a part of the target is enough."""

    @classmethod
    @abstractmethod
    def of_size(cls, size: tuple[int, int], square_m: float, **options: float | str) -> Self:
        """The target of `size` = (columns, rows), pitch `square_m` [m] and its own options.

        Raises BadParameter for an option the target does not have.
        """

    @property
    @abstractmethod
    def points(self) -> Float[Array, "n 3"]:
        """Positions of all points in the board frame [m]; a point's id is its row here."""

    @property
    @abstractmethod
    def size(self) -> str:
        """Columns and rows as on the command line, such as ``9x6``."""

    @property
    @abstractmethod
    def description(self) -> str:
        """One line that names the target completely; it is printed on it."""

    @property
    @abstractmethod
    def origin_m(self) -> tuple[float, float]:
        """Where point 0 lies on the printed page, from its top-left corner (x, y) [m]."""

    @property
    @abstractmethod
    def size_m(self) -> tuple[float, float]:
        """Width and height of the printed target with its quiet margin [m]."""

    @abstractmethod
    def drawing(self) -> Drawing:
        """The printed target; its page has the size `size_m`."""

    @abstractmethod
    def detect(self, image: Image, *, name: str = "") -> Corners | None:
        """The target's points in a picture called `name`, or None when it is not seen.

        ``Corners.sigma_px`` is the one-sigma error of each point.
        """
