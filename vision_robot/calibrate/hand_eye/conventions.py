"""Whether the arm's poses mean what they are taken for: found by what fits the pictures.

Each mistake leaves a mark: a wrong unit scales the arm's shifts, a wrong quaternion order or Euler order
changes every turn, poses given the wrong way round, or the other set-up, fit only when inverted. A closed
form is fitted under each meaning; where another one explains the views many times better, that one is said.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.hand_eye.pose_table import LENGTHS, PoseTable, Reading
from vision_robot.calibrate.hand_eye.rotations import EULER_ORDERS
from vision_robot.calibrate.hand_eye.setup import Setup
from vision_robot.calibrate.hand_eye.start import Fit, closed_fit, consistent_fit
from vision_robot.calibrate.hand_eye.words import degrees, millimetres
from vision_robot.errors import BadPoseFile, ContradictingPoses
from vision_robot.geometry import SE3

__all__ = ["CONTRADICTION", "Meaning", "check_meaning", "meanings"]

CONTRADICTION = 2e-3
"""Typical disagreement (turn [rad], and shift over the board's distance) below which nothing is asked: 0.1
degrees, 1 mm at half a metre."""

BETTER = 5.0
"""Times a meaning must disagree less to be believed instead of the one given."""

FEWEST_TO_TELL = 4
"""Three poses have two motions: almost any meaning fits them."""


@dataclass(frozen=True)
class Meaning:
    """Another meaning of the same numbers: what the poses then are, in words, and how to say so."""

    mount_from_far: SE3
    words: str
    mend: str


def meanings(table: PoseTable, setup: Setup) -> Iterator[Meaning]:
    """Mistakes that people make, one at a time; then an angle's unit together with a length's."""
    if not table.has_poses:
        return
    reading = table.reading
    seen = {reading}
    for other, words, mend in _readings(reading):
        if other in seen:
            continue
        seen.add(other)
        try:
            pose = table.read_as(other).base_from_wrist
        except BadPoseFile:
            continue
        yield Meaning(setup.mount_from_far(pose), words, mend)
        yield Meaning(
            setup.mount_from_far(pose.inverse()),
            f"{words}, and as wrist_from_base or the other set-up",
            f"{mend}, with --inverse or --setup {setup.other.name}",
        )


def _readings(reading: Reading) -> Iterator[tuple[Reading, str, str]]:
    yield reading, "", ""
    lengths = [unit for unit in LENGTHS if unit != reading.length]
    turns = [(reading, "", "")]
    if reading.kind == "quaternion":
        order = "xyzw" if reading.order == "wxyz" else "wxyz"
        turns.append(
            (replace(reading, order=order), f"quaternions in the order {order}", f"--rotation {order}")
        )
    if reading.kind in ("rotvec", "euler"):
        angle = "deg" if reading.angle == "rad" else "rad"
        name = "degrees" if angle == "deg" else "radians"
        turns.append((replace(reading, angle=angle), f"angles in {name}", f"--angle-unit {angle}"))
    if reading.kind == "euler":
        for angle in dict.fromkeys((reading.angle, "rad", "deg")):
            for order in EULER_ORDERS:
                words = f"Euler angles {order} in {'degrees' if angle == 'deg' else 'radians'}"
                other = replace(reading, order=order, angle=angle)
                turns.append((other, words, f"--rotation {order} --angle-unit {angle}"))
    if reading.kind == "rotvec":
        for order in EULER_ORDERS:
            for angle in ("rad", "deg"):
                words = f"Euler angles {order} in {'degrees' if angle == 'deg' else 'radians'}"
                other = replace(reading, kind="euler", order=order, angle=angle)
                turns.append((other, words, f"--rotation {order} --angle-unit {angle}"))
    if reading.kind == "matrix":
        turns.append(
            (replace(reading, transposed=True), "matrices written column by column", "--rotation columns")
        )
    for turned, words, mend in turns:
        if words:
            yield turned, words, mend
        for unit in lengths:
            both = f"{words} and lengths in {unit}" if words else f"lengths in {unit}"
            yield replace(turned, length=unit), both, f"{mend} --pose-unit {unit}".strip()


def check_meaning(table: PoseTable, setup: Setup, cam_from_board: SE3) -> Fit:
    """The fit under the given meaning; raises ContradictingPoses where another explains far more.

    Raises BadPoseFile where numbers are no rotations.
    """
    given = setup.mount_from_far(table.base_from_wrist)
    fit = consistent_fit(given, cam_from_board)
    if fit.typical < CONTRADICTION or len(cam_from_board) < FEWEST_TO_TELL:
        return fit
    inverse = Meaning(
        given.inverse(),
        "as wrist_from_base instead of base_from_wrist, which is also how the other set-up would look",
        f"give --inverse if the poses are wrist_from_base, or --setup {setup.other.name} if "
        f"{'the camera stands still' if setup.carries_camera else 'the arm carries the camera'}",
    )
    tried = [
        (closed_fit(one.mount_from_far, cam_from_board).typical, one)
        for one in [inverse, *meanings(table, setup)]
    ]
    best, meaning = min(tried, key=lambda pair: pair[0])
    if best * BETTER < fit.typical:
        how = meaning.words if meaning.words.startswith("as ") else f"as {meaning.words}"
        raise ContradictingPoses(
            f"read as {table.reading.words} they disagree by {_size(fit)}, read {how} "
            f"by {best / fit.typical:.1%} of that",
            meaning.mend if meaning.mend.startswith("give") else f"give {meaning.mend}",
        )
    return fit


def _size(fit: Fit) -> str:
    return f"{degrees(float(np.median(fit.turn)))} and {millimetres(float(np.median(fit.shift_m)))}"
