"""Who carries what: the camera on the wrist before a standing board, or the other way round."""

from dataclasses import dataclass

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3

__all__ = ["EYE_IN_HAND", "EYE_TO_HAND", "SETUPS", "Setup", "setup_named"]


@dataclass(frozen=True)
class Setup:
    """One of the two arrangements of camera, board and arm.

    The camera is mounted on one end of the arm (`mount`), the board on the other (`far`), the ends
    being base {B} and wrist {W}. What stands still in the room is *fixed* to the base, what moves is
    *carried* by the wrist:
    ``base_from_wrist = base_from_fixed @ fixed_from_carried @ wrist_from_carried.inverse()``.
    """

    name: str
    carries_camera: bool

    @property
    def mount(self) -> str:
        """Frame the camera is mounted on, as its transforms are named."""
        return "wrist" if self.carries_camera else "base"

    @property
    def far(self) -> str:
        """Frame the board is mounted on."""
        return "base" if self.carries_camera else "wrist"

    @property
    def other(self) -> "Setup":
        """The arrangement this one is mistaken for."""
        return EYE_TO_HAND if self.carries_camera else EYE_IN_HAND

    def fixed_from_carried(self, cam_from_board: SE3) -> SE3:
        """What the pictures tell, from the carried thing's frame to the fixed one's."""
        return cam_from_board.inverse() if self.carries_camera else cam_from_board

    def mount_from_far(self, base_from_wrist: SE3) -> SE3:
        """What the arm tells, from the board's end to the camera's."""
        return base_from_wrist.inverse() if self.carries_camera else base_from_wrist

    def fixed_and_carried(self, mount_from_cam: SE3, far_from_board: SE3) -> tuple[SE3, SE3]:
        """base_from_fixed and wrist_from_carried."""
        return (far_from_board, mount_from_cam) if self.carries_camera else (mount_from_cam, far_from_board)


EYE_IN_HAND = Setup("eye-in-hand", carries_camera=True)
EYE_TO_HAND = Setup("eye-to-hand", carries_camera=False)

SETUPS: dict[str, Setup] = {setup.name: setup for setup in (EYE_IN_HAND, EYE_TO_HAND)}


def setup_named(name: str) -> Setup:
    """The arrangement of that name; raises BadParameter listing both."""
    if name not in SETUPS:
        raise BadParameter("set-up", name, " or ".join(SETUPS))
    return SETUPS[name]
