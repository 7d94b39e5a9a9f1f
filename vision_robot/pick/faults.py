"""What may be wrong with a cell: faults change the truth and tell the controller nothing."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot.geometry.lens import LENSES
from vision_robot.pick.world import World

__all__ = ["FAULTS", "Fault", "with_fault"]


@dataclass(frozen=True)
class Fault:
    """A fault of a size: `unit` is rad, m, s, levels, or empty for a share."""

    unit: str
    meaning: str
    apply: Callable[[World, float], World]
    least: float = -np.inf
    most: float = np.inf


def _camera_rotation(world: World, size: float) -> World:
    """About the two axes across the line of sight alike, which moves everything in the picture."""
    return _knocked(world, SE3.from_rotvec(np.array([size, size, 0.0]) / np.sqrt(2), np.zeros(3)))


def _camera_translation(world: World, size: float) -> World:
    return _knocked(world, SE3(np.eye(3), np.array([size, size, 0.0]) / np.sqrt(2)))


def _knocked(world: World, again: SE3) -> World:
    """One knock after the other."""
    return replace(world, knock=again @ world.knock)


def _joint_offset(world: World, size: float) -> World:
    hinges = ~world.arm.chain.slides
    signs = np.where(np.arange(len(hinges)) % 2 == 0, -1.0, 1.0)
    return replace(world, joint_offset=np.where(hinges, signs * size, 0.0))


def _backlash(world: World, size: float) -> World:
    return replace(world, backlash=np.where(world.arm.chain.slides, 0.0, size))


FAULTS: dict[str, Fault] = {
    "camera-rotation": Fault("rad", "the camera is turned after it was calibrated", _camera_rotation),
    "camera-translation": Fault("m", "the camera is shifted after it was calibrated", _camera_translation),
    "square-size": Fault(
        "",
        "the board's squares are larger than what was typed by this share",
        lambda world, size: replace(world, square_scale=1 + size),
        least=-0.5,
        most=1.0,
    ),
    "joint-offset": Fault("rad", "encoders are off, from joint to joint to the other side", _joint_offset),
    "backlash": Fault("rad", "play in every turning joint", _backlash, least=0),
    "corner-noise": Fault(
        "px",
        "noise of the corners that the cell is calibrated with",
        lambda world, size: replace(world, corner_noise_px=size),
        least=1e-3,
    ),
    "image-noise": Fault(
        "levels", "noise of the pictures", lambda world, size: replace(world, image_noise=size), least=0
    ),
    "latency": Fault(
        "s", "time from a picture to its answer", lambda world, size: replace(world, latency_s=size), least=0
    ),
    "lost-sight": Fault(
        "",
        "share of pictures in which the hand's label is not seen",
        lambda world, size: replace(world, lost_sight=size),
        least=0,
        most=1,
    ),
}
"""Name -> fault."""


def with_fault(world: World, name: str, size: float) -> World:
    """The world with that fault. Raises BadParameter for an unknown name, listing the known."""
    if name not in FAULTS:
        raise BadParameter("fault", name, f"one of {', '.join(FAULTS)}, lens")
    fault = FAULTS[name]
    if not (np.isfinite(size) and fault.least <= size <= fault.most):
        unit = f" {fault.unit}" if fault.unit else ""
        allowed = f"a number from {fault.least:g} to {fault.most:g}{unit}"
        raise BadParameter(f"size of fault {name}", size, allowed)
    return fault.apply(world, size)


def with_lens(world: World, lens: str) -> World:
    """The world calibrated with a lens model that may be too simple for its camera."""
    if lens not in LENSES:
        raise BadParameter("lens", lens, f"one of {', '.join(LENSES)}")
    return replace(world, lens=lens)
