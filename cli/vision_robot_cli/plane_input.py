"""What `vr extrinsics plane` starts from, and the fit it leads to."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

import numpy as np

from vision_robot.calibrate import Corners, calibrate
from vision_robot.calibrate.boards import Board
from vision_robot.calibrate.detect import detect_boards
from vision_robot.calibrate.result import Rejected
from vision_robot.errors import BadParameter, BoardNotFound, MixedImageSizes
from vision_robot.extrinsics.marked_points import read_marked_points
from vision_robot.extrinsics.plane import PlaneFit, fit_plane, on_station
from vision_robot.extrinsics.plane_held_out import HeldOut, held_out
from vision_robot.formats import read_known_camera
from vision_robot.geometry import SE3, KnownCamera, WorkPlane
from vision_robot.images import open_images
from vision_robot.types import Array, Float, Image
from vision_robot_cli.output import note, progress, ticking

__all__ = [
    "PlaneFound",
    "PlaneInput",
    "found",
    "from_pictures",
    "from_points",
    "known_camera",
    "lying",
    "rendered",
]


@dataclass(frozen=True)
class PlaneInput:
    """Points seen, where they lie on the board, and where the board lies."""

    source: str
    known: KnownCamera
    views: list[Corners]
    points: Float[Array, "n 3"]
    station_from_board: SE3
    board: Board | None = None
    rejected: list[Rejected] = field(default_factory=list)
    pictures: Mapping[str, Image] = field(default_factory=dict)
    truth: WorkPlane | None = None
    seconds: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class PlaneFound:
    """The fit and what held-out points say of it."""

    fit: PlaneFit
    held_out: HeldOut | None


def known_camera(path: Path | None, name: str | None) -> KnownCamera:
    """The options --camera and --camera-name."""
    if path is None:
        raise BadParameter("--camera", None, "given: the file that 'vr calibrate -o camera.json' wrote, say")
    known = read_known_camera(path, name=name)
    if known.taken_as_exact:
        note(f"{path} holds no covariance: the camera is taken as exact, and only the pixels' noise counts")
    return known


def lying(offset_m: tuple[float, float], yaw_deg: float, height_m: float, z: str, *, marked: bool) -> SE3:
    """The options --offset, --yaw, --height and --z: station_from_board."""
    if z not in ("up", "down"):
        raise BadParameter("--z", z, "up or down")
    if not np.isfinite(yaw_deg):
        raise BadParameter("--yaw", yaw_deg, "a finite angle in degrees")
    if marked:
        if any(offset_m) or yaw_deg or height_m:
            raise BadParameter(
                "--points", "with --offset, --yaw or --height", "given alone: X and Y say it all"
            )
        return SE3.identity()
    return on_station(offset_m, np.radians(yaw_deg), height_m, z_up=z == "up")


def from_points(path: Path, known: KnownCamera, station_from_board: SE3) -> PlaneInput:
    """The option --points."""
    seen, positions = read_marked_points(path)
    return PlaneInput(str(path), known, [seen], positions, station_from_board)


def from_pictures(paths: Sequence[str], board: Board, known: KnownCamera, laid: SE3) -> PlaneInput:
    """Photos by the fixed camera."""
    if not paths:
        raise BadParameter("photos of the table", None, "given; or --points FILE, or --synthetic")
    pictures = open_images(paths)
    return _detected(", ".join(paths), pictures, board, known, laid)


def rendered(board: Board, seed: int) -> PlaneInput:
    """A camera calibrated from rendered boards, then the board on a rendered table; all truth is known."""
    from vision_robot_synth.calibration import calibration_set
    from vision_robot_synth.table import table_set

    calibration, table = calibration_set(board=board, seed=seed), table_set(board=board, seed=seed)
    start = perf_counter()
    boards = list(progress(calibration.images(), "rendering boards", total=len(calibration)))
    pictures = {f"table {i}": image for i, image in enumerate(table.images())}
    seconds = {"render": perf_counter() - start}
    start = perf_counter()
    corners = [
        one for one in detect_boards({f"{i}": b for i, b in enumerate(boards)}, board) if one is not None
    ]
    result = calibrate(corners, board.points, (table.camera.width, table.camera.height))
    seconds["calibrate"] = perf_counter() - start
    known = KnownCamera(result.camera, result.covariance.intrinsics)
    given = _detected("rendered", pictures, board, known, table.station_from_board[0])
    truth = WorkPlane.exact(table.camera, table.cam_from_station)
    return PlaneInput(
        **{**vars(given), "truth": truth, "seconds": {**seconds, **given.seconds}},
    )


def found(given: PlaneInput, sigma_px: float | None) -> PlaneFound:
    """Fit the plane and hold points out."""
    start = perf_counter()
    fit = fit_plane(given.known, given.views, given.points, given.station_from_board, sigma_px=sigma_px)
    given.seconds["solve"] = perf_counter() - start
    return PlaneFound(fit, held_out(given.known, fit, given.points, given.station_from_board))


def _detected(
    source: str, pictures: Mapping[str, Image], board: Board, known: KnownCamera, laid: SE3
) -> PlaneInput:
    start = perf_counter()
    with ticking("finding the board") as tick:
        seen = detect_boards(pictures, board, progress=tick)
    wanted = f"{board.name} {board.size}"
    views = [one for one in seen if one is not None]
    names = list(pictures)
    if not views or seen[0] is None:
        raise BoardNotFound(len(names) if not views else 1, wanted)
    height, width = pictures[names[0]].shape[:2]
    size = (known.camera.width, known.camera.height)
    if (width, height) != size:
        raise MixedImageSizes("the camera file", size, names[0], (width, height))
    rejected = [
        Rejected(name, f"no {wanted} board found")
        for name, one in zip(names, seen, strict=True)
        if one is None
    ]
    seconds = {"detect": perf_counter() - start}
    return PlaneInput(
        source, known, views, board.points, laid, board, rejected, pictures=pictures, seconds=seconds
    )
