"""What `vr extrinsics hand-eye` starts from, whichever way it was given."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath
from time import perf_counter
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from vision_robot.calibrate import Corners, Rejected
from vision_robot.calibrate.boards import Board
from vision_robot.calibrate.corner_files import read_corner_folder, read_model_points
from vision_robot.calibrate.detect import detect_boards, seen_size
from vision_robot.calibrate.hand_eye.pose_file import read_poses
from vision_robot.calibrate.hand_eye.pose_table import LENGTHS, PoseTable, Reading
from vision_robot.calibrate.hand_eye.rotations import is_euler_order
from vision_robot.calibrate.hand_eye.setup import setup_named
from vision_robot.errors import BadParameter, BadPoseFile, BoardNotFound, MixedImageSizes
from vision_robot.formats import read_known_camera
from vision_robot.geometry import SE3, KnownCamera, SerialChain
from vision_robot.images import open_images
from vision_robot.types import Array, Float, Image
from vision_robot_cli.output import note, ticking
from vision_robot_cli.quantities import length_m

if TYPE_CHECKING:
    from vision_robot_synth.hand_eye import HandEyeSet

__all__ = [
    "HandEyeInput",
    "HandEyeOptions",
    "detected",
    "from_corner_files",
    "from_pictures",
    "keep_set",
    "synthetic_set",
]

Result = TypeVar("Result")

INTRINSICS = ("known", "fixed", "free")
PICTURES_FOR_A_HINT = 4


@dataclass(frozen=True)
class HandEyeOptions:
    """The options that say what numbers mean and what is estimated."""

    setup: str
    rotation: str | None
    pose_unit: str | None
    angle_unit: str | None
    inverse: bool
    arm: str | None
    geometry: bool
    intrinsics: str

    def check(self, *, synthetic: bool, auto: bool, given: bool) -> None:
        """Refuse options that make no sense, before any work is done."""
        setup_named(self.setup)
        if self.intrinsics not in INTRINSICS:
            raise BadParameter("--intrinsics", self.intrinsics, " or ".join(INTRINSICS))
        if self.pose_unit is not None and self.pose_unit not in LENGTHS:
            raise BadParameter("--pose-unit", self.pose_unit, " or ".join(LENGTHS))
        if self.angle_unit not in (None, "rad", "deg"):
            raise BadParameter("--angle-unit", self.angle_unit, "rad or deg")
        known = (None, "rotvec", "matrix", "columns")
        if self.rotation not in known and not (
            sorted(self.rotation or "") == sorted("wxyz") or is_euler_order(self.rotation or "")
        ):
            allowed = (
                "wxyz, xyzw, rotvec, matrix, columns, or three axes such as xyz (fixed) or ZYX (turning)"
            )
            raise BadParameter("--rotation", self.rotation, allowed)
        if auto and not synthetic:
            raise BadParameter(
                "--auto", "without --synthetic", "given with it: the arm that drives is MuJoCo's"
            )
        if synthetic and given:
            raise BadParameter("--synthetic", "with pictures or poses", "given alone")
        if not synthetic and not given:
            raise BadParameter("pictures", None, "given with --poses and --camera; or try --synthetic")
        if self.geometry and not self.arm and not synthetic:
            raise BadParameter("--geometry", "without --arm", "given with the arm's model")

    def reading(self, table: PoseTable) -> Reading:
        """What the file's columns say, overruled by the options."""
        reading = table.reading
        width = table.turn.shape[1]
        kinds = {"rotvec": ("rotvec", 3), "matrix": ("matrix", 9), "columns": ("matrix", 9)}
        if self.rotation is not None and table.has_poses:
            name = self.rotation
            kind, wanted = kinds.get(name, ("quaternion", 4) if len(name) == 4 else ("euler", 3))
            if wanted != width:
                raise BadParameter("--rotation", name, f"one of {width} numbers, as {table.source} has")
            reading = replace(reading, kind=kind, order=name, transposed=name == "columns")
        return replace(
            reading,
            length=self.pose_unit or reading.length,
            angle=self.angle_unit or reading.angle,
            inverse=reading.inverse != self.inverse,
        )


@dataclass
class HandEyeInput:
    """Corners and poses of the same views, the board, the camera, and where they came from."""

    source: str
    corners: list[Corners]
    poses: PoseTable | SE3
    points: Float[Array, "n 3"]
    camera: KnownCamera
    rejected: list[Rejected] = field(default_factory=list)
    arm: SerialChain | None = None
    joints: Float[Array, "views j"] | None = None
    board: Board | None = None
    truth: "HandEyeSet | None" = None
    pictures: Mapping[str, Image] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    driven: list[str] = field(default_factory=list)
    """What the arm did by itself, step by step."""

    def timed(self, stage: str, work: Callable[[], Result]) -> Result:
        """Do the work and note how long it took."""
        start = perf_counter()
        result = work()
        self.seconds[stage] = perf_counter() - start
        return result


@dataclass(frozen=True)
class _Files:
    """The options --poses, --camera and --arm."""

    table: PoseTable
    camera: KnownCamera
    arm: SerialChain | None


def from_pictures(
    paths: Sequence[str], board: Board, poses: Path | None, camera: Path | None, asked: HandEyeOptions
) -> HandEyeInput:
    """Photos and a pose file."""
    files = _files(poses, camera, asked)
    pictures = open_images(paths)
    rows = paired(files.table, list(pictures))
    start = perf_counter()
    corners, rejected = detected(pictures, board, files.camera)
    given = _joined(", ".join(paths), files, list(pictures), rows, corners, board.points)
    return replace(
        given,
        rejected=[*rejected, *given.rejected],
        board=board,
        pictures=pictures,
        seconds={"detect": perf_counter() - start},
    )


def from_corner_files(
    folder: Path | None,
    model_points: Path | None,
    poses: Path | None,
    camera: Path | None,
    asked: HandEyeOptions,
) -> HandEyeInput:
    """The options --corners and --model-points, and a pose file."""
    if folder is None or model_points is None:
        missing = "--corners" if folder is None else "--model-points"
        raise BadParameter(missing, None, "given: --corners DIR and --model-points FILE go together")
    files = _files(poses, camera, asked)
    points = read_model_points(model_points)
    left_out = [path for path in (model_points, poses, camera) if path is not None]
    views = {view.image: view for view in read_corner_folder(folder, len(points), leave_out=left_out)}
    rows = paired(files.table, list(views))
    return _joined(str(folder), files, list(views), rows, views, points)


def _files(poses: Path | None, camera: Path | None, asked: HandEyeOptions) -> _Files:
    if poses is None:
        raise BadParameter("--poses", None, "given: a CSV or JSON file with one pose of the arm a picture")
    if camera is None:
        raise BadParameter("--camera", None, "given: the file that 'vr calibrate -o camera.json' wrote, say")
    table = read_poses(poses)
    table = table.read_as(asked.reading(table))
    known = read_known_camera(camera)
    if asked.intrinsics == "fixed":
        known = KnownCamera.exact(known.camera)
    if asked.arm is None:
        if not table.has_poses:
            raise BadPoseFile(poses, "it holds joint values only: give the arm's model with --arm")
        return _Files(table, known, None)
    from vision_robot.arm import read_arm

    chain = read_arm(asked.arm).chain
    table.joint_values(chain)
    return _Files(table, known, chain)


def paired(table: PoseTable, names: Sequence[str]) -> list[int | None]:
    """The row of each picture's pose: by name where the file names pictures, else by order."""
    if table.names is None:
        if len(table) != len(names):
            raise BadPoseFile(
                table.source,
                f"it holds {len(table)} poses and there are {len(names)} pictures: give one pose a picture "
                "in "
                "the same order, or name the pictures in a column called image",
            )
        return list(range(len(table)))
    by_name: dict[str, int] = {}
    for i, full in enumerate(table.names):
        if full in by_name:
            raise BadPoseFile(table.source, f"{table.rows[i]}: {full} has a pose already")
        by_name[full] = i
    for full, i in list(by_name.items()):
        path = PurePath(full)
        by_name.setdefault(path.name, i)
        by_name.setdefault(path.stem, i)
    rows = [
        next(
            (by_name[key] for key in (name, PurePath(name).name, PurePath(name).stem) if key in by_name), None
        )
        for name in names
    ]
    if all(row is None for row in rows):
        raise BadPoseFile(
            table.source,
            f"it names pictures ({table.names[0]}, ...) of which none is given ({names[0]}, ...)",
        )
    return rows


def _joined(
    source: str,
    files: _Files,
    names: Sequence[str],
    rows: Sequence[int | None],
    corners: Mapping[str, Corners],
    points: Float[Array, "n 3"],
) -> HandEyeInput:
    """Views that have both a pose and a board."""
    lost = [name for name, row in zip(names, rows, strict=True) if row is None]
    both = [(name, row) for name, row in zip(names, rows, strict=True) if row is not None and name in corners]
    table = files.table.keeping([row for _, row in both])
    return HandEyeInput(
        source=source,
        corners=[corners[name] for name, _ in both],
        poses=table,
        points=points,
        camera=files.camera,
        rejected=[Rejected(name, f"{table.source} has no pose for it") for name in lost],
        arm=files.arm,
        joints=table.joint_values(files.arm) if files.arm is not None else None,
    )


def detected(
    pictures: Mapping[str, Image], board: Board, known: KnownCamera
) -> tuple[dict[str, Corners], list[Rejected]]:
    """Corners by picture, and the pictures without a board."""
    names = list(pictures)
    with ticking("finding the board") as tick:
        found = detect_boards(pictures, board, progress=tick)
    wanted = f"{board.name} {board.size}"
    corners = {name: view for name, view in zip(names, found, strict=True) if view is not None}
    if not corners:
        seen = (seen_size(pictures[name]) for name in names[:PICTURES_FOR_A_HINT])
        raise BoardNotFound(len(names), wanted, next((size for size in seen if size), None))
    height, width = pictures[names[0]].shape[:2]
    camera = known.camera
    if (width, height) != (camera.width, camera.height):
        raise MixedImageSizes("the camera file", (camera.width, camera.height), names[0], (width, height))
    rejected = [Rejected(name, f"no {wanted} board found") for name in names if name not in corners]
    return corners, rejected


def synthetic_set(
    asked: HandEyeOptions, board: Board, *, views: int, link_error: str, seed: int
) -> "HandEyeSet":
    """The options --synthetic, --arm (column, six-axis), --views and --link-error."""
    from vision_robot_synth.hand_eye import hand_eye_set

    return hand_eye_set(
        asked.setup,
        arm=asked.arm or "column",
        views=views,
        board=board,
        link_errors=_link_errors(link_error),
        seed=seed,
    )


def _link_errors(text: str) -> tuple[float, float]:
    """``1mm,0.3deg`` as (turn [rad], shift [m])."""
    turn = shift = 0.0
    for word in text.split(","):
        plain = word.strip()
        if plain in ("0", ""):
            continue
        if plain.endswith("deg"):
            try:
                turn = float(np.radians(float(plain.removesuffix("deg"))))
            except ValueError:
                raise BadParameter(
                    "--link-error", text, "a length and an angle, such as 1mm,0.3deg"
                ) from None
        else:
            shift = length_m(plain, "--link-error")
    return turn, shift


def keep_set(given: HandEyeInput, folder: Path) -> None:
    """The option --keep."""
    from vision_robot_synth.hand_eye_folder import write_hand_eye_set

    assert given.truth is not None
    write_hand_eye_set(given.truth, folder)
    note(f"pictures, poses.csv and camera.json written to {folder}")
