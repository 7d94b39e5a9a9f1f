"""What `vr extrinsics rig` starts from, and the fit it leads to."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from time import perf_counter

from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.boards import Board
from vision_robot.calibrate.detect import detect_boards, seen_size
from vision_robot.errors import BadParameter, BoardNotFound, MixedImageSizes, VisionRobotError
from vision_robot.extrinsics.rig import RigFit, fit_rig
from vision_robot.extrinsics.rig_held_out import BoardError, held_out_boards
from vision_robot.formats import read_known_camera
from vision_robot.geometry import CameraRig, KnownCamera
from vision_robot.images import ImageSource, open_images
from vision_robot.types import Image
from vision_robot_cli.output import note, ticking

__all__ = ["RigFound", "RigInput", "found", "from_folders", "rendered"]


@dataclass(frozen=True)
class RigInput:
    """What each camera saw by moment, and what is known of the cameras."""

    names: list[str]
    cameras: list[KnownCamera]
    sightings: list[dict[str, Corners]]
    board: Board
    calibrated: bool
    """Whether the cameras come from these very pictures."""
    truth: CameraRig | None = None
    seconds: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class RigFound:
    """The fit and what held-out boards say of it."""

    fit: RigFit
    held_out: BoardError | None


def from_folders(folders: Sequence[Path], cameras: Sequence[Path], board: Board, model: str) -> RigInput:
    """The arguments and the option --camera."""
    if len(folders) < 2:
        raise BadParameter("folders", [str(f) for f in folders], "two or more, one a camera; or --synthetic")
    if cameras and len(cameras) != len(folders):
        allowed = f"given for all {len(folders)} folders, or none"
        raise BadParameter("--camera", f"given {len(cameras)} times", allowed)
    names = [folder.name or str(folder) for folder in folders]
    if len(set(names)) < len(names):
        names = [str(folder) for folder in folders]
    if len(set(names)) < len(names):
        raise BadParameter("folders", names, "different")
    pictures = [open_images([folder]) for folder in folders]
    keys = _moments([list(one) for one in pictures], names)
    known = [read_known_camera(path) for path in cameras]
    renamed = [
        ImageSource({key: partial(source.__getitem__, name) for key, name in zip(k, source, strict=True)})
        for k, source in zip(keys, pictures, strict=True)
    ]
    return _detected(names, renamed, known, board, model)


def _moments(files: Sequence[Sequence[str]], names: Sequence[str]) -> list[list[str]]:
    """The moment of each file: its stem; its last number where stems never match."""
    stems = [[Path(name).stem for name in one] for one in files]
    if _shared(stems):
        return stems
    numbers = [[(re.findall(r"\d+", stem) or [""])[-1].lstrip("0") or "0" for stem in one] for one in stems]
    if _shared(numbers) and all(len(set(one)) == len(one) for one in numbers):
        note("file names differ between the folders: pictures are matched by the last number in their names")
        return numbers
    first = ", ".join(f"{name}/{one[0]}" for name, one in zip(names, files, strict=True))
    allowed = "named alike in all folders where they were taken at the same moment"
    raise BadParameter("pictures", first, allowed)


def _shared(keys: Sequence[Sequence[str]]) -> bool:
    return any(set(a) & set(b) for i, a in enumerate(keys) for b in keys[i + 1 :])


def rendered(board: Board, moments: int, seed: int, model: str) -> RigInput:
    """A rig rendered in MuJoCo, with its truth; its cameras are calibrated from the same pictures."""
    from vision_robot_synth.rig import rig_set

    if moments < 4:
        raise BadParameter("--moments", moments, "4 or more")
    truth = rig_set(board, moments=moments, seed=seed)
    start = perf_counter()
    pictures = []
    for i, name in enumerate(truth.rig.names):
        note(f"rendering camera {name}")
        pictures.append(dict(truth.images(i)))
    seconds = {"render": perf_counter() - start}
    given = _detected(list(truth.rig.names), pictures, [], board, model)
    return replace(given, truth=truth.rig, seconds={**seconds, **given.seconds})


def _detected(
    names: list[str],
    pictures: Sequence[Mapping[str, Image]],
    known: list[KnownCamera],
    board: Board,
    model: str,
) -> RigInput:
    start = perf_counter()
    wanted = f"{board.name} {board.size}"
    sightings, sizes = [], []
    for name, images in zip(names, pictures, strict=True):
        with ticking(f"finding the board for {name}") as tick:
            found = detect_boards(images, board, progress=tick)
        seen = {
            moment: replace(corners, image=f"{name}: {moment}")
            for moment, corners in zip(images, found, strict=True)
            if corners is not None
        }
        first = images[next(iter(images))]
        if not seen:
            raise BoardNotFound(len(images), f"{wanted} (camera {name})", seen_size(first))
        sightings.append(seen)
        sizes.append((first.shape[1], first.shape[0]))
    seconds = {"detect": perf_counter() - start}
    for name, camera, size in zip(names, known, sizes, strict=False):
        expected = (camera.camera.width, camera.camera.height)
        if expected != size:
            raise MixedImageSizes(f"the camera file of {name}", expected, f"pictures of {name}", size)
    calibrated = not known
    if calibrated:
        start = perf_counter()
        known = [
            _calibrated(name, list(seen.values()), board, size, model)
            for name, seen, size in zip(names, sightings, sizes, strict=True)
        ]
        seconds["calibrate"] = perf_counter() - start
    return RigInput(names, known, sightings, board, calibrated, seconds=seconds)


def _calibrated(
    name: str, corners: list[Corners], board: Board, size: tuple[int, int], model: str
) -> KnownCamera:
    """A start for the bundle, which sees the same corners again: so nothing is said of its covariance."""
    try:
        return KnownCamera.exact(calibrate(corners, board.points, size, Settings(model=model)).camera)
    except VisionRobotError as error:
        raise BadParameter(
            f"camera {name}", "not calibrated from its own pictures", f"given with --camera ({error})"
        ) from error


def found(given: RigInput, *, refine: bool, warp: int) -> RigFound:
    """Fit the rig and hold moments out."""
    start = perf_counter()
    points = given.board.points
    fit = fit_rig(given.names, given.cameras, given.sightings, points, refine=refine, warp=warp)
    given.seconds["solve"] = perf_counter() - start
    return RigFound(fit, held_out_boards(given.names, given.cameras, given.sightings, points, fit))
