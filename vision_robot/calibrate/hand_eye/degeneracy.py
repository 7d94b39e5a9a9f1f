"""What the arm's motions can tell, asked before any number is given.

In ``A X = X B`` the camera's position t enters as (R_A - I) t: what no motion turns stays unknown. Over all
motions ``G = mean((R_A - I)^T (R_A - I))`` has as eigenvalues the mean squared effect of a shift of the
camera along each eigenvector; the smallest belongs to the axis that all motions share. How the camera
is turned needs two axes too, or shifts across one (Tsai & Lenz 1989, lemma 1 and 2).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vision_robot.calibrate.hand_eye.motions import HALF_TURN, motions
from vision_robot.calibrate.hand_eye.setup import Setup
from vision_robot.calibrate.hand_eye.words import degrees, direction
from vision_robot.errors import DegeneratePoses, TooFewPoses
from vision_robot.geometry import SE3, SerialChain
from vision_robot.types import Array, Float

__all__ = ["FEWEST_POSES", "LEAST_TURN", "Motion", "check_motion", "motion_of", "unmoved_joints"]

FEWEST_POSES = 3
LEAST_TURN = np.radians(1.0)
"""Root mean square turn that a direction must feel: from here an error of 0.02 degrees is 2 % of a lever."""

NOISY = 10.0
"""Turns of fewer times their own noise have an axis that is noise."""

SAME_TURN, SAME_SHIFT_M = np.radians(0.05), 2e-4
"""Poses nearer to each other than this tell nothing new of the mounting."""

STILL, STILL_M = np.radians(2.0), 5e-3
"""A joint that moves by less is as good as not moved."""


@dataclass(frozen=True)
class Motion:
    """How much the motions turn.

    `felt` [rad] is the root mean square turn that a shift of the camera along each of the rows of
    `directions` (in the mount's frame) feels, least first.
    """

    felt: Float[Array, "3"]
    directions: Float[Array, "3 3"]
    largest: float
    """Largest angle between two poses [rad]."""
    distinct: int
    """How many of the poses differ from each other."""

    @property
    def axis(self) -> Float[Array, "3"]:
        """The direction along which the camera's position is known least."""
        return self.directions[0]


def motion_of(mount_from_far: SE3, *, whole: bool = True) -> Motion:
    """Summary of all motions; with `whole` half turns count too, else only those whose axis has a sign."""
    pairs = motions(mount_from_far, mount_from_far)
    pairs = pairs if whole else pairs.have_axes
    turned = pairs.a.rotation - np.eye(3)
    G = np.einsum("nij,nik->jk", turned, turned) / max(len(pairs), 1)
    values, vectors = np.linalg.eigh(G)
    largest = float(np.linalg.norm(pairs.turned_a, axis=1).max(initial=0.0))
    return Motion(np.sqrt(np.maximum(values, 0)), vectors.T, largest, _distinct(mount_from_far))


def _distinct(poses: SE3) -> int:
    """How many poses are left when near copies count once."""
    kept: list[int] = []
    for i in range(len(poses)):
        to = poses[i].inverse() @ poses[np.array(kept, dtype=int)] if kept else None
        if (
            to is None
            or not (
                (np.linalg.norm(to.rotvec(), axis=-1) < SAME_TURN)
                & (np.linalg.norm(to.translation, axis=-1) < SAME_SHIFT_M)
            ).any()
        ):
            kept.append(i)
    return len(kept)


def check_motion(
    setup: Setup,
    mount_from_far: SE3,
    *,
    given: int,
    turn_noise: float = 0.0,
    idle: Sequence[str] = (),
) -> Motion:
    """The motions' summary; raises where they leave something open, in words.

    Args:
        setup: Who carries what.
        mount_from_far: The arm's poses, from the board's end to the camera's.
        given: How many pairs there were at first, for the error.
        turn_noise: Standard deviation of the arm's turns [rad], where it is known already.
        idle: Names of joints that were not moved, where joint values are known.

    Raises:
        TooFewPoses: Fewer than three different poses.
        DegeneratePoses: No turn, one axis, or half turns only.
    """
    motion = motion_of(mount_from_far)
    n = len(mount_from_far)
    if motion.distinct < FEWEST_POSES:
        why = f"only {motion.distinct} of them differ from each other" if n >= FEWEST_POSES else ""
        raise TooFewPoses(motion.distinct, FEWEST_POSES, given, why)
    least = max(LEAST_TURN, NOISY * turn_noise)
    mount = setup.mount
    move = f" ({' and '.join(idle)} did not move)" if idle else ""
    if motion.felt[2] < least:
        raise DegeneratePoses(
            (f"where the camera sits on the {mount}",),
            "all poses are parallel to each other, none turned from another by more than "
            f"{degrees(motion.largest)}{move}",
            "turn the wrist by 30-90 degrees between views, about at least two different axes",
        )
    if motion.felt[0] < least:
        along = direction(motion.axis, mount)
        raise DegeneratePoses(
            (f"the camera's position along {along}",),
            f"all motions turn about that one axis, about others by {degrees(float(motion.felt[0]))}{move}",
            f"also turn the wrist by 30-60 degrees about axes across it"
            f"{f', with {idle[0]}' if len(idle) == 1 else ''}",
        )
    signed = motion_of(mount_from_far, whole=False)
    if signed.felt[0] < least:
        raise DegeneratePoses(
            ("how the camera is turned",),
            f"but for one axis all motions are half turns, over {degrees(HALF_TURN)}, whose axis has no sign",
            "add poses that are turned by 30-120 degrees",
        )
    return motion


def unmoved_joints(chain: SerialChain, joints: Float[Array, "views n"]) -> tuple[str, ...]:
    """Names of hinges that stayed where they were; slides turn nothing and are left out."""
    still = np.ptp(joints, axis=0) < np.where(chain.slides, STILL_M, STILL)
    return tuple(
        name
        for name, idle, slides in zip(chain.joint_names, still, chain.slides, strict=True)
        if idle and not slides
    )
