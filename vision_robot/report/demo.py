"""The page of `vr demo`: from camera to grasp on one page, each chapter told by its own room."""

from collections.abc import Mapping
from dataclasses import dataclass

from vision_robot.arm.consistency import Consistency
from vision_robot.arm.workspace import Workspace
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.evaluate.picking import ladder
from vision_robot.evaluate.projection import projection_error
from vision_robot.extrinsics.plane import PlaneFit
from vision_robot.pick.summary import summary_of
from vision_robot.pick.world import World
from vision_robot.report.arm import arm_piece
from vision_robot.report.calibration import calibration_piece
from vision_robot.report.page import Facts, Footer, Page, Paragraph, Section
from vision_robot.report.pick import PickStory, picks_piece
from vision_robot.report.plane import plane_piece
from vision_robot.report.quantity import compact
from vision_robot.report.trackers import Answer, trackers_piece
from vision_robot.report.versions import versions
from vision_robot.tracks import Tracks
from vision_robot.types import Image

__all__ = ["DemoStory", "demo_page"]


@dataclass(frozen=True)
class DemoStory:
    """Everything that happened, in the order of the data's way."""

    world: World
    camera: CalibrationResult
    views: Mapping[str, Image]
    plane: PlaneFit
    on_table: Image
    """The board on the table, as the camera sees it."""
    answers: Mapping[str, Answer]
    truth: Tracks
    frames: tuple[Image, ...]
    checks: tuple[Consistency, ...]
    reach: Workspace
    picks: Mapping[str, PickStory]
    """Name of a condition -> its episodes; the first is the ordinary one."""
    seconds: Mapping[str, float]


def demo_page(story: DemoStory, *, command: str = "", seed: int | None = None) -> Page:
    """One page with the whole way from an unknown camera to a rod that is put down where it belongs."""
    world = story.world
    chapters = (
        (
            "1. The camera",
            "A printed board is photographed from all sides; its corners, found to a hundredth of a "
            "pixel, tell "
            "focal lengths, principal point and distortion.",
            calibration_piece(story.camera, world.view.camera, story.views),
        ),
        (
            "2. The table",
            "One picture of the board lying on the table tells where the table is; from now on a pixel is "
            "a place "
            "in millimetres, with its uncertainty.",
            plane_piece(story.plane, world.truth.plane, story.on_table),
        ),
        (
            "3. Three trackers",
            "A rod wanders over the table, and three trackers that work by different means say where it is.",
            trackers_piece(story.answers, story.truth, story.frames),
        ),
        (
            "4. The arm",
            "Inverse kinematics gives the joint values that bring the gripper to a place on the table.",
            arm_piece(world.arm, story.checks, story.reach),
        ),
        (
            "5. The pick",
            "The camera and the table of chapters 1 and 2 are all that the arm goes by. Then the camera "
            "is knocked, "
            "and the arm picks again: with its eyes shut on the way, and looking at its own hand.",
            picks_piece(story.picks),
        ),
    )
    sections = [Section(title, (Paragraph(words), *parts)) for title, words, parts in chapters]
    total = sum(story.seconds.values())
    return Page(
        "From camera to grasp",
        "A camera is calibrated, a table measured, a rod tracked, joints solved, and the rod picked and "
        "placed: "
        f"all rendered and simulated with its truth known, in {total:.0f} s.",
        (Section("In short", (_facts(story),)), *sections),
        Footer(versions(), seed, command),
    )


def _facts(story: DemoStory) -> Facts:
    error = projection_error(story.camera.camera, story.world.view.camera)
    best = min(story.answers.items(), key=lambda one: one[1].figures["centroid_error_px"])
    first = next(iter(story.picks.values()))
    found, lifted = summary_of(first.episodes), ladder(first.episodes)["lifted"]
    fastest = max(check.solves_per_s for check in story.checks)
    return Facts(
        (
            ("camera off by", f"{compact(error.rms_px, 2)} px", "rms over the whole picture"),
            ("best tracker", best[0], f"{compact(best[1].figures['centroid_error_px'], 2)} px off, median"),
            ("inverse kinematics", f"{compact(fastest / 1e3, 2)} thousand / s", "solutions of one core"),
            (
                "grasped and held",
                f"{found.reached_rung['lifted']} of {found.episodes}",
                f"{compact(1000 * found.position_m.median, 2)} mm off at closing; 95 % interval "
                f"{100 * lifted.low:.0f} to {100 * lifted.high:.0f} %",
            ),
        )
    )
