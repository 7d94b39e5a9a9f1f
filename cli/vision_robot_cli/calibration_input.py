"""What `vr calibrate` starts from, whichever way it was given."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import perf_counter
from typing import TypeVar

from vision_robot.calibrate import Corners, Rejected, Settings
from vision_robot.calibrate.boards import Board
from vision_robot.calibrate.circle_bias import DiscBoard
from vision_robot.calibrate.corner_files import read_corner_folder, read_model_points, size_holding
from vision_robot.calibrate.detect import detect_boards, seen_size
from vision_robot.calibrate.warp import HIGHEST_DEGREE
from vision_robot.errors import BadParameter, BoardNotFound
from vision_robot.geometry import LENSES, Camera
from vision_robot.geometry.camera import AFFINE_NAMES
from vision_robot.images import open_images
from vision_robot.types import Array, Float, Image
from vision_robot_cli.output import note, progress, ticking
from vision_robot_cli.quantities import whole_pair

__all__ = [
    "CalibrationInput",
    "from_corner_files",
    "from_pictures",
    "rendered",
    "rendered_folder",
]

Result = TypeVar("Result")

AUTO = "auto"

PICTURES_FOR_A_HINT = 4
"""Pictures that are searched for a board of another size where none of the asked size is found."""


@dataclass
class CalibrationInput:
    """Corners, the board they lie on, and where they came from."""

    source: str
    corners: list[Corners]
    points: Float[Array, "n 3"]
    size: tuple[int, int]
    rejected: list[Rejected] = field(default_factory=list)
    board: Board | None = None
    truth: Camera | None = None
    size_assumed: bool = False
    pictures: Mapping[str, Image] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def discs(self) -> DiscBoard | None:
        """The board where its points are centres of discs, whose images are off-centre."""
        return self.board if isinstance(self.board, DiscBoard) else None

    def timed(self, stage: str, work: Callable[[], Result]) -> Result:
        """Do the work and note how long it took."""
        start = perf_counter()
        result = work()
        self.seconds[stage] = perf_counter() - start
        return result


def candidates(model: str, skew: bool, fix: Sequence[str], prior: Sequence[str], warp: str) -> list[Settings]:
    """The options --model, --skew, --fix, --prior and --warp; several where one of them says auto."""
    fixed = {}
    for word in fix:
        name, _, value = word.partition("=")
        fixed[name.strip()] = _number("--fix", word, value or "0")
    priors = {}
    for word in prior:
        name, equals, rest = word.partition("=")
        mean, sign, sigma = rest.replace("±", "+-").partition("+-")
        if not (equals and sign):
            raise BadParameter("--prior", word, "a name, a mean and a standard deviation: cx=640+-5")
        priors[name.strip()] = (_number("--prior", word, mean), _number("--prior", word, sigma))
    if warp != AUTO and not warp.isdecimal():
        raise BadParameter("--warp", warp, f"auto, or a whole number from 0 to {HIGHEST_DEGREE}")
    degrees = range(HIGHEST_DEGREE + 1) if warp == AUTO else [int(warp)]
    named = [*fixed, *priors]
    models = [
        name for name, lens in LENSES.items() if {*named} <= {*AFFINE_NAMES, *lens.coefficient_names}
    ] if model == AUTO else [model]  # fmt: skip
    if not models:
        raise BadParameter("--fix and --prior", ", ".join(named), "parameters that one lens model has")
    return [
        Settings(model=one, skew=skew, fixed=fixed, priors=priors, warp=degree)
        for one in models
        for degree in degrees
    ]


def from_corner_files(
    folder: Path | None, model_points: Path | None, image_size: str | None
) -> CalibrationInput:
    """The options --corners, --model-points and --image-size."""
    if folder is None or model_points is None:
        missing = "--corners" if folder is None else "--model-points"
        raise BadParameter(missing, None, "given: --corners DIR and --model-points FILE go together")
    points = read_model_points(model_points)
    corners = read_corner_folder(folder, len(points), leave_out=[model_points])
    size = whole_pair(image_size, "--image-size") if image_size else size_holding(corners)
    return CalibrationInput(str(folder), corners, points, size, size_assumed=image_size is None)


def from_pictures(paths: Sequence[str], board: Board, topic: str | None = None) -> CalibrationInput:
    """Photos, folders, patterns, a video or a ROS bag."""
    pictures = open_images(paths, topic=topic)
    return _detected(", ".join(paths), pictures, board)


def rendered(board: Board, views: int, seed: int) -> CalibrationInput:
    """A set rendered in MuJoCo, with its truth."""
    from vision_robot_synth.calibration import calibration_set

    truth = calibration_set(board=board, views=views, seed=seed)
    start = perf_counter()
    images = progress(truth.images(), "rendering", total=views)
    pictures = {f"view {i:02d}": image for i, image in enumerate(images)}
    seconds = {"render": perf_counter() - start}
    given = _detected("rendered", pictures, board)
    return replace(given, truth=truth.camera, seconds={**seconds, **given.seconds})


def rendered_folder(folder: Path, views: int, seed: int, camera: Camera | None = None) -> CalibrationInput:
    """The same, kept as a dataset on disk, where a second run finds it again; by any `camera`."""
    from vision_robot_synth.calibration import calibration_set
    from vision_robot_synth.calibration_folder import write_calibration_set

    truth = calibration_set(camera, views=views, seed=seed)
    start = perf_counter()
    note(f"rendering {views} views into {folder}")
    write_calibration_set(truth, folder)
    seconds = {"render": perf_counter() - start}
    given = from_pictures([str(folder / "frames")], truth.board)
    return replace(given, truth=truth.camera, seconds={**seconds, **given.seconds})


def _detected(source: str, pictures: Mapping[str, Image], board: Board) -> CalibrationInput:
    start = perf_counter()
    with ticking("finding the board") as tick:
        found = detect_boards(pictures, board, progress=tick)
    names = list(pictures)
    corners = [view for view in found if view is not None]
    wanted = f"{board.name} {board.size}"
    missing = [name for name, view in zip(names, found, strict=True) if view is None]
    if not corners:
        seen = (seen_size(pictures[name]) for name in names[:PICTURES_FOR_A_HINT])
        raise BoardNotFound(len(names), wanted, next((size for size in seen if size), None))
    height, width = pictures[names[0]].shape[:2]
    rejected = [Rejected(name, f"no {wanted} board found") for name in missing]
    given = CalibrationInput(
        source, corners, board.points, (width, height), rejected, board, pictures=pictures
    )
    given.seconds["detect"] = perf_counter() - start
    return given


def _number(option: str, word: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise BadParameter(option, word, "a name and a number, such as k3=0") from None
