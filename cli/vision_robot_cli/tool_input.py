"""What `vr extrinsics tool` starts from, and the fit it leads to."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

import numpy as np

from vision_robot.calibrate.hand_eye.pose_file import read_poses
from vision_robot.errors import BadParameter, BadTable, MixedImageSizes
from vision_robot.extrinsics.bead import COLOURS, find_bead
from vision_robot.extrinsics.marked_points import read_table
from vision_robot.extrinsics.pivot import PivotFit, fit_pivot
from vision_robot.extrinsics.tip_view import TipView
from vision_robot.extrinsics.tool import ToolFit, fit_tool
from vision_robot.formats import read_known_camera
from vision_robot.formats.hand_eye import read_hand_eye
from vision_robot.geometry import SE3, KnownCamera, skew
from vision_robot.images import open_images
from vision_robot.types import Array, Float, Image
from vision_robot_cli.output import note, progress

__all__ = ["ToolInput", "found", "given", "rendered"]


@dataclass(frozen=True)
class ToolInput:
    """Poses and sightings; no views where the tip touched one point."""

    base_from_wrist: SE3
    views: list[TipView]
    truth: Float[Array, "3"] | None = None
    seconds: dict[str, float] = field(default_factory=dict)


def found(given: ToolInput) -> ToolFit | PivotFit:
    """The fit."""
    start = perf_counter()
    fit = fit_tool(given.base_from_wrist, given.views) if given.views else fit_pivot(given.base_from_wrist)
    given.seconds["solve"] = perf_counter() - start
    return fit


def given(
    poses: Path | None,
    folders: Sequence[Path],
    tips: Sequence[Path],
    cameras: Sequence[Path],
    hand_eyes: Sequence[Path],
    bead: str,
    *,
    pivot: bool,
) -> ToolInput:
    """The options of a person with a robot."""
    if poses is None:
        raise BadParameter("--poses", None, "given: the robot's poses; or --synthetic")
    wrist = read_poses(poses).base_from_wrist
    if pivot:
        if folders or tips or cameras or hand_eyes:
            raise BadParameter("--pivot", "with pictures or cameras", "given with --poses alone")
        return ToolInput(wrist, [])
    if bool(folders) == bool(tips):
        raise BadParameter("sightings", "none, or from both", "folders of pictures, or --tips; or --pivot")
    if bool(cameras) == bool(hand_eyes):
        raise BadParameter("cameras", "none, or from both", "given with --camera or with --hand-eye")
    sources = folders or tips
    files = cameras or hand_eyes
    if len(sources) != len(files):
        raise BadParameter("camera files", len(files), f"{len(sources)}, one for each folder or --tips")
    start = perf_counter()
    views = []
    for source, file in zip(sources, files, strict=True):
        blank = (
            _placed(source.name, file)
            if hand_eyes
            else TipView(source.name, read_known_camera(file), _none(0))
        )
        pixels, sigma = (
            _from_pictures(source, blank.known, bead, len(wrist))
            if folders
            else _from_table(source, len(wrist))
        )
        views.append(
            TipView(blank.name, blank.known, pixels, sigma, blank.cam_from_base, blank.pose_covariance)
        )
    return ToolInput(wrist, views, seconds={"detect": perf_counter() - start})


def _none(count: int) -> Float[Array, "n 2"]:
    return np.full((count, 2), np.nan)


def _placed(name: str, file: Path) -> TipView:
    """A camera beside the arm whose place a hand-eye calibration told."""
    known = read_hand_eye(file)
    if known.setup != "eye-to-hand":
        raise BadParameter(
            "--hand-eye", str(file), "of a camera that stands still beside the arm (eye-to-hand)"
        )
    base_from_cam = known.mount_from_cam
    back = base_from_cam.rotation.T
    # The inverse's own step: -R^T w turns it, and R^T (w x t - dt) shifts it.
    carry = np.zeros((6, 6))
    carry[:3, :3] = carry[3:, 3:] = -back
    carry[3:, :3] = -back @ skew(base_from_cam.translation)
    covariance = carry @ known.covariance[:6, :6] @ carry.T
    return TipView(name, KnownCamera.exact(known.camera), _none(0), 1.0, base_from_cam.inverse(), covariance)


def _from_table(path: Path, count: int) -> tuple[Float[Array, "n 2"], float]:
    """Pixels by pose, all of one weight: their noise is found from the residuals."""
    table = read_table(path, ("pose", "u_px", "v_px"))
    pixels = _none(count)
    for line, (pose, u, v) in enumerate(
        zip(table["pose"], table["u_px"], table["v_px"], strict=True), start=2
    ):
        if pose != int(pose) or not 1 <= pose <= count:
            raise BadTable(path, f"line {line}: pose is {pose:g}, a whole number from 1 to {count} expected")
        if np.isfinite(pixels[int(pose) - 1]).all():
            raise BadTable(path, f"line {line}: pose {pose:g} is there twice")
        pixels[int(pose) - 1] = u, v
    return pixels, 1.0


def _from_pictures(
    folder: Path, known: KnownCamera, bead: str, count: int
) -> tuple[Float[Array, "n 2"], float]:
    pictures = open_images([folder])
    if len(pictures) != count:
        raise BadParameter(
            f"pictures in {folder}", len(pictures), f"{count}, one for each of the robot's poses"
        )
    images = (pictures[name] for name in progress(pictures, f"finding the tip in {folder.name}", count))
    return _tips(folder.name, images, count, known, bead)


def _tips(
    name: str, images: Iterable[Image], count: int, known: KnownCamera, bead: str
) -> tuple[Float[Array, "n 2"], float]:
    rgb = _colour(bead)
    pixels, sigmas = _none(count), []
    expected = (known.camera.width, known.camera.height)
    for k, image in enumerate(images):
        size = (image.shape[1], image.shape[0])
        if size != expected:
            raise MixedImageSizes(f"the camera file of {name}", expected, f"picture {k + 1} of {name}", size)
        seen = find_bead(image, rgb)
        if seen is not None:
            pixels[k] = seen[0]
            sigmas.append(seen[1])
    if not sigmas:
        raise BadParameter(
            f"pictures of {name}", f"no {bead} bead in any", "ones that show the bead; see --bead"
        )
    if len(sigmas) < count:
        note(f"{name}: the bead is seen in {len(sigmas)} of {count} pictures")
    return pixels, float(np.median(sigmas))


def _colour(text: str) -> tuple[int, int, int]:
    if text in COLOURS:
        return COLOURS[text]
    try:
        red, green, blue = (int(part) for part in text.split(","))
    except ValueError:
        raise BadParameter("--bead", text, f"one of {', '.join(COLOURS)}, or red,green,blue") from None
    if not all(0 <= part <= 255 for part in (red, green, blue)):
        raise BadParameter("--bead", text, "three numbers from 0 to 255")
    return red, green, blue


def rendered(poses: int, seed: int) -> ToolInput:
    """The column arm with a probe, rendered in MuJoCo; the cameras' places are found with the tip."""
    from vision_robot_synth.tool import tool_set

    made = tool_set(poses=poses, seed=seed)
    start = perf_counter()
    views = []
    for i, camera in enumerate(made.cameras):
        name = f"camera {i + 1}"
        images = progress(made.images(i), f"rendering {name}", total=poses)
        known = KnownCamera.exact(camera)
        pixels, sigma = _tips(name, images, poses, known, "red")
        views.append(TipView(name, known, pixels, sigma))
    return ToolInput(made.base_from_wrist, views, made.tip, {"render": perf_counter() - start})
