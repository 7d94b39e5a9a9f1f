"""Whether the arm's poses mean what they are taken for: found by what fits the pictures.

Each mistake leaves a mark: a wrong unit scales the arm's shifts, a wrong quaternion order or Euler order
changes every turn, poses given the wrong way round, or the other set-up, fit only when inverted. A closed
form is fitted under each meaning; where another one explains the views many times better, that one is said.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.hand_eye.pose_table import LENGTHS, PoseTable, Reading
from vision_robot.calibrate.hand_eye.rotations import ANGLES, EULER_ORDERS
from vision_robot.calibrate.hand_eye.setup import Setup
from vision_robot.calibrate.hand_eye.start import Fit, closed_fit, consistent_fit
from vision_robot.calibrate.hand_eye.words import degrees, millimetres
from vision_robot.errors import BadPoseFile, ContradictingPoses
from vision_robot.geometry import SE3, SerialChain, rotation_log
from vision_robot.types import Array, Float

__all__ = ["BETTER", "CONTRADICTION", "Meaning", "check_joints", "check_meaning", "meanings"]

CONTRADICTION = 2e-3
"""Typical disagreement (turn [rad], and shift over the board's distance) below which nothing is asked: 0.1
degrees, 1 mm at half a metre."""

BETTER = 5.0
"""Times a meaning must disagree less to be believed instead of the one given."""

MOST_TURNED = 4
"""Readings of rotations that are tried with every unit and direction."""

FEWEST_TO_TELL = 4
"""Three poses have two motions: almost any meaning fits them."""


@dataclass(frozen=True)
class Meaning:
    """Another meaning of the same numbers: what the poses then are, in words, and how to say so."""

    mount_from_far: SE3
    words: str
    mend: str


Turned = tuple[Reading, str, str]
"""A reading, what is other about its rotations, and the options that say so."""


def meanings(table: PoseTable, setup: Setup, cam_from_board: SE3) -> Iterator[Meaning]:
    """Mistakes that people make: with the rotations, with lengths, with the direction, and all together.

    Of the readings of rotations only those are tried whose motions turn most nearly as much as the
    pictures': an angle does not depend on the frame.
    """
    angle = _angles(cam_from_board.rotation)
    ranked = []
    for k, (reading, words, mend) in enumerate(_turned_readings(table.reading)):
        try:
            pose = table.read_as(reading).base_from_wrist
        except BadPoseFile:
            continue
        off = float(np.median(np.abs(_angles(pose.rotation) - angle)))
        ranked.append((round(off, 6), k, reading, words, mend))
    for _, _, reading, words, mend in sorted(ranked)[:MOST_TURNED]:
        for unit in LENGTHS:
            said = [words] if words else []
            given = [mend] if mend else []
            if unit != reading.length:
                said.append(f"lengths in {unit}")
                given.append(f"--pose-unit {unit}")
            pose = table.read_as(replace(reading, length=unit)).base_from_wrist
            both, options = " and ".join(said), " ".join(given)
            if said:
                yield Meaning(setup.mount_from_far(pose), both, options)
                yield Meaning(
                    setup.mount_from_far(pose.inverse()),
                    f"{both}, and as wrist_from_base or the other set-up",
                    f"{options}, with --inverse or --setup {setup.other.name}",
                )


def _angles(rotation: Float[Array, "n 3 3"]) -> Float[Array, "m"]:
    """Angles of the motions between each view and the next three."""
    n = len(rotation)
    pairs = [(i, i + k) for k in (1, 2, 3) for i in range(n - k)]
    first, second = np.array(pairs).T
    return np.linalg.norm(rotation_log(rotation[first] @ np.swapaxes(rotation[second], 1, 2)), axis=1)


def _turned_readings(reading: Reading) -> Iterator[Turned]:
    """The reading itself, then those whose rotations are another's."""
    yield reading, "", ""
    if reading.kind == "quaternion":
        order = "xyzw" if reading.order == "wxyz" else "wxyz"
        words = f"quaternions in the order {order}"
        yield replace(reading, order=order), words, f"--rotation {order}"
    if reading.kind == "matrix":
        yield replace(reading, transposed=True), "matrices written column by column", "--rotation columns"
    if reading.kind not in ANGLES:
        return
    for angle in ("rad", "deg"):
        name = "degrees" if angle == "deg" else "radians"
        if angle != reading.angle:
            yield replace(reading, angle=angle), f"angles in {name}", f"--angle-unit {angle}"
        for order in EULER_ORDERS:
            other = replace(reading, kind="euler", order=order, angle=angle)
            if order != reading.order:
                words = f"Euler angles {order} in {name}"
                yield other, words, f"--rotation {order} --angle-unit {angle}"
        if reading.kind == "euler":
            other = replace(reading, kind="rotvec", order="", angle=angle)
            yield other, f"rotation vectors in {name}", f"--rotation rotvec --angle-unit {angle}"


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
        for one in [inverse, *meanings(table, setup, cam_from_board)]
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


def check_joints(arm: SerialChain, joints: Float[Array, "n j"], setup: Setup, cam_from_board: SE3) -> Fit:
    """The fit for joint values; raises ContradictingPoses where another unit or set-up explains far more."""
    fit = consistent_fit(setup.mount_from_far(arm.base_from_wrist(joints)), cam_from_board)
    if fit.typical < CONTRADICTION or len(cam_from_board) < FEWEST_TO_TELL:
        return fit
    other = setup.other
    tried = [(closed_fit(other.mount_from_far(arm.base_from_wrist(joints)), cam_from_board).typical,
              f"as {other.name}", f"give --setup {other.name}")]  # fmt: skip
    for turn, slide, words in (
        (np.pi / 180, 1.0, "as hinges in degrees"),
        (1.0, 1e-3, "as slides in millimetres"),
        (np.pi / 180, 1e-3, "as hinges in degrees and slides in millimetres"),
    ):
        pose = arm.base_from_wrist(joints * np.where(arm.slides, slide, turn))
        mend = "name the joints' columns with their units, such as theta2_deg or d1_mm"
        tried.append((closed_fit(setup.mount_from_far(pose), cam_from_board).typical, words, mend))
    best, words, mend = min(tried)
    if best * BETTER < fit.typical:
        raise ContradictingPoses(
            f"the joint values put the wrist off by {_size(fit)}, read {words} by {best / fit.typical:.1%} "
            "of that",
            mend,
        )
    return fit


def _size(fit: Fit) -> str:
    return f"{degrees(float(np.median(fit.turn)))} and {millimetres(float(np.median(fit.shift_m)))}"
