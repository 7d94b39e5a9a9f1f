"""The synthetic arm of `vr extrinsics hand-eye --synthetic`: photographs a set, or drives by itself."""

from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING

from vision_robot.calibrate import Corners
from vision_robot.calibrate.detect import detect_board
from vision_robot.calibrate.hand_eye.words import millimetres
from vision_robot.errors import DegeneratePoses, TooFewPoses
from vision_robot.geometry import KnownCamera
from vision_robot.types import Image
from vision_robot_cli.hand_eye_input import HandEyeInput, HandEyeOptions, detected
from vision_robot_cli.hand_eye_verdict import solved
from vision_robot_cli.output import note, progress
from vision_robot_cli.quantities import length_m

if TYPE_CHECKING:
    from vision_robot_synth.hand_eye import HandEyeSet

__all__ = ["FIRST_VIEWS", "driven", "rendered"]

FIRST_VIEWS = 4
"""Drawn by chance, so that there is a calibration to ask for the next best pose."""


def rendered(made: "HandEyeSet") -> HandEyeInput:
    """All views of a set, photographed and detected."""
    start = perf_counter()
    images = progress(made.images(), "rendering", total=len(made))
    pictures = dict(zip(made.names, images, strict=True))
    render = perf_counter() - start
    corners, rejected = detected(pictures, made.board, KnownCamera.exact(made.camera))
    given = _given(made, corners, pictures)
    seconds = {"render": render, "detect": perf_counter() - start - render}
    return replace(given, rejected=rejected, seconds=seconds)


def driven(made: "HandEyeSet", asked: HandEyeOptions, most: int, until: str, seed: int) -> HandEyeInput:
    """From a few views to as many as it takes: each next one from the next best pose."""
    wanted = length_m(until, "--until")
    given = rendered(made)
    corners = {view.image: view for view in given.corners}
    pictures = dict(given.pictures)
    steps: list[str] = []
    tried = 0
    while len(made) < most:
        try:
            verdict = solved(given, asked, seed)
        except (DegeneratePoses, TooFewPoses) as error:
            # The first views were unlucky: take one more of the same kind.
            note(f"{len(made)} views: {error}")
            made = _one_more_by_chance(made, asked, seed)
        else:
            sigma = verdict.result.covariance.position_m
            steps.append(f"{len(corners)} views: sigma {millimetres(sigma)}")
            note(steps[-1])
            proposed = verdict.judgement.next_poses
            if sigma <= wanted or proposed is None or proposed.joints is None:
                break
            made = made.driven_to(proposed.joints[min(tried, len(proposed) - 1)])
        name = made.names[-1]
        (picture,) = made.images([len(made) - 1])
        pictures[name] = picture
        found = detect_board(picture, made.board, name=name)
        # A pose from which the board was not found is not proposed again at once.
        tried = 0 if found is not None else tried + 1
        if found is not None:
            corners[name] = found
        seconds = given.seconds
        given = replace(_given(made, corners, pictures), rejected=given.rejected, seconds=seconds)
    return replace(given, driven=steps)


def _given(made: "HandEyeSet", corners: dict[str, Corners], pictures: dict[str, Image]) -> HandEyeInput:
    index = [i for i, name in enumerate(made.names) if name in corners]
    return HandEyeInput(
        source=f"rendered from the {made.setup} cell",
        corners=[corners[made.names[i]] for i in index],
        poses=made.said[index],
        points=made.board.points,
        camera=KnownCamera.exact(made.camera),
        arm=made.cell.arm,
        joints=made.joints[index],
        board=made.board,
        truth=made,
        pictures=pictures,
    )


def _one_more_by_chance(made: "HandEyeSet", asked: HandEyeOptions, seed: int) -> "HandEyeSet":
    from vision_robot_synth.hand_eye import hand_eye_set

    other = hand_eye_set(
        asked.setup, arm=asked.arm or "column", views=1, board=made.board, seed=seed + 1000 * len(made)
    )
    return made.driven_to(other.joints[0])
