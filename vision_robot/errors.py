"""Everything this library raises on purpose.

One root, `VisionRobotError`; below it `BadInput` for what the caller can mend.
Every message says what is wrong, where, and how to mend it; the evidence is kept
as attributes so that a caller can act on it without parsing text.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

__all__ = [
    "BadArm",
    "AmbiguousPlane",
    "BadCameraFile",
    "BadCornerFile",
    "BadFrame",
    "BadGoal",
    "BadInput",
    "BadParameter",
    "BadPath",
    "BadPort",
    "BadPoseFile",
    "BadDataset",
    "BadRecipe",
    "BadTable",
    "BadVideo",
    "BoardNotFound",
    "BrokenPlugin",
    "ContradictingPoses",
    "DegeneratePoses",
    "CommandRefused",
    "DegenerateViews",
    "LinkMismatch",
    "MissingLimits",
    "EdgeOnPlane",
    "MissingOpenGL",
    "MissingPackage",
    "MixedImageSizes",
    "NoAnswer",
    "NoColour",
    "NoConvergence",
    "NoImages",
    "NoScheduler",
    "NothingSeen",
    "PeerFailed",
    "TooFewPoses",
    "TooFewViews",
    "UnknownStructure",
    "TooLittleMotion",
    "OffPlane",
    "UnlinkedCameras",
    "Unsynchronised",
    "UnlevelBoard",
    "Unreachable",
    "UnreadableImage",
    "UnwritableOutput",
    "VisionRobotError",
]


class VisionRobotError(Exception):
    """Root of all errors of this library."""

    def __reduce__(self) -> tuple[Any, ...]:
        # Exceptions are pickled as a call with their message; ours take the evidence instead, and
        # have to come back from other processes.
        return _rebuilt, (type(self), self.args, self.__dict__)


def _rebuilt(
    cls: type[VisionRobotError], args: tuple[Any, ...], evidence: dict[str, Any]
) -> VisionRobotError:
    error = cls.__new__(cls, *args)
    error.__dict__.update(evidence)
    return error


class NoConvergence(VisionRobotError):
    """An iteration ended without reaching its tolerance."""


class MissingOpenGL(VisionRobotError):
    """No OpenGL back end works on this machine."""

    def __init__(self, tried: dict[str, str]):
        self.tried = tried
        reasons = "; ".join(f"{backend}: {why}" for backend, why in tried.items())
        super().__init__(
            f"no OpenGL back end can render ({reasons}): install one with "
            "'apt-get install libegl1 libgl1 libgl1-mesa-dri' or 'pip install --no-deps lavavu-osmesa'"
        )


class NoAnswer(VisionRobotError):
    """The other end of a serial line keeps silent."""

    def __init__(self, port: str, message: str, sequence: int, tries: int, timeout_s: float):
        self.port, self.message, self.sequence = port, message, sequence
        self.tries, self.timeout_s = tries, timeout_s
        super().__init__(
            f"{port}: no answer to {message} number {sequence}, sent {tries} time(s) and waited for "
            f"{1e3 * timeout_s:.0f} ms each: check cable, baud rate and that the receiver runs; "
            "whether the command was carried out is not known"
        )


class CommandRefused(VisionRobotError):
    """A microcontroller did not do what it was told, and said why."""

    def __init__(self, port: str, message: str, sequence: int, status: str, meaning: str):
        self.port, self.message, self.sequence, self.status = port, message, sequence, status
        super().__init__(f"{port}: {message} number {sequence} was refused ({status}): {meaning}")


class MissingPackage(VisionRobotError):
    """An optional package is needed for what was asked."""

    def __init__(self, package: str, purpose: str):
        self.package, self.purpose = package, purpose
        super().__init__(f"{purpose} needs the package {package}: install it with 'pip install {package}'")


class PeerFailed(VisionRobotError):
    """Another program that was to be measured ended badly."""

    def __init__(self, command: str, why: str):
        self.command, self.why = command, why
        super().__init__(f"'{command}' failed: {why}")


class NothingSeen(VisionRobotError):
    """A tracker says nothing of an object that is there."""

    def __init__(self, tracker: str, name: str):
        self.tracker, self.name = tracker, name
        super().__init__(f"tracker {tracker} does not see {name}")


class Unreachable(VisionRobotError):
    """No joint values bring the tool to a goal."""

    def __init__(self, position_m: Sequence[float], short_m: float):
        self.position_m, self.short_m = tuple(map(float, position_m)), short_m
        where = ", ".join(f"{1000 * x:.0f}" for x in self.position_m)
        short = f"{1000 * short_m:.1f} mm are missing"
        super().__init__(f"the arm cannot reach ({where}) mm of the station: {short}")


class BadInput(VisionRobotError):
    """The caller gave something that cannot be used and can mend it."""


class BadParameter(BadInput):
    """An argument has a value outside what is allowed."""

    def __init__(self, name: str, value: object, allowed: str):
        self.name, self.value, self.allowed = name, value, allowed
        super().__init__(f"{name} is {value!r}: it must be {allowed}")


class NoImages(BadInput):
    """A path names no image."""

    def __init__(self, paths: Iterable[object]):
        self.paths = [str(path) for path in paths]
        super().__init__(
            f"no image found in {', '.join(self.paths) or 'an empty list'}: "
            "give image files, a folder of images, a quoted pattern or a video"
        )


class NoScheduler(BadInput):
    """No cluster answers where one was named."""

    def __init__(self, address: str, why: str):
        self.address, self.why = address, why
        super().__init__(f"no scheduler answers at {address} ({why}): start one with 'dask scheduler'")


class UnreadableImage(BadInput):
    """A file exists but holds no image that can be decoded."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be read as an image ({why}): remove or replace it")


class MixedImageSizes(BadInput):
    """Images of one camera differ in size."""

    def __init__(self, first: object, size: tuple[int, int], other: object, other_size: tuple[int, int]):
        self.size, self.other_size = size, other_size
        super().__init__(
            f"{other} is {other_size[0]}x{other_size[1]} px but {first} is {size[0]}x{size[1]} px: "
            "one calibration needs images of one camera at one resolution"
        )


class BoardNotFound(BadInput):
    """No image shows the board that was asked for."""

    def __init__(self, images: int, wanted: str, seen: str | None = None):
        self.images, self.wanted, self.seen = images, wanted, seen
        hint = f"; a board of {seen} was seen: try --size {seen}" if seen else "; check --board and --size"
        super().__init__(f"no {wanted} board found in {images} image(s){hint}")


class TooFewViews(BadInput):
    """Fewer usable views than a calibration needs."""

    def __init__(self, usable: int, needed: int, given: int):
        self.usable, self.needed, self.given = usable, needed, given
        super().__init__(
            f"{usable} usable view(s) of {given} given: at least {needed} are needed; "
            "add images that show the whole board at different tilts"
        )


class DegenerateViews(BadInput):
    """The views leave parameters undetermined."""

    def __init__(self, undetermined: Sequence[str], why: str):
        self.undetermined, self.why = tuple(undetermined), why
        affine = {"fx", "fy", "cx", "cy", "skew"} & set(undetermined)
        mend = (
            "add views in which the board is tilted by 20-60 degrees in different directions"
            if affine
            else "take a simpler --model or --fix them, or add views that reach the picture's corners"
        )
        super().__init__(f"{', '.join(undetermined)} cannot be known from these views ({why}): {mend}")


class EdgeOnPlane(BadInput):
    """A plane is seen so nearly from the side that the picture does not tell where it is."""

    def __init__(self, image: str, elevation_deg: float, across_px: float):
        self.image, self.elevation_deg, self.across_px = image, elevation_deg, across_px
        super().__init__(
            f"{image} sees the plane edge-on (line of sight {elevation_deg:.1f} degrees above it, its points "
            f"within {across_px:.2g} px of a line): look down on it by 10 degrees or more"
        )


class AmbiguousPlane(BadInput):
    """Two tilts of a plane, mirrored about the line of sight, explain a picture equally well."""

    def __init__(self, image: str, apart_deg: float, gap_sigma: float):
        self.image, self.apart_deg, self.gap_sigma = image, apart_deg, gap_sigma
        super().__init__(
            f"{image} does not tell which of two tilts, {apart_deg:.1f} degrees apart, the plane has (they "
            f"differ by {gap_sigma:.1f} sigma): take the photo from nearer, or with a larger board or points "
            "farther apart"
        )


class UnlevelBoard(BadInput):
    """A board does not lie on the plane that the first view shows."""

    def __init__(self, image: str, height_mm: float, tilt_deg: float):
        self.image, self.height_mm, self.tilt_deg = image, height_mm, tilt_deg
        super().__init__(
            f"the board in {image} does not lie on the plane of the first photo ({height_mm:+.1f} mm off it, "
            f"tilted by {tilt_deg:.1f} degrees): lay it flat on the table, and keep the camera still"
        )


class UnlinkedCameras(BadInput):
    """Cameras of a rig that never saw the board at the same moment as the others."""

    def __init__(self, linked: Sequence[str], unlinked: Sequence[str]):
        self.linked, self.unlinked = tuple(linked), tuple(unlinked)
        super().__init__(
            f"{', '.join(unlinked)} never saw the board at the same moment as {', '.join(linked)}: take "
            "pictures with the board where two cameras see it, and give them one file name in both folders"
        )


class Unsynchronised(BadInput):
    """Two cameras of a rig do not show the board at the same places at the same moments."""

    def __init__(self, first: str, second: str, agreeing: int, moments: int, lag: int | None):
        self.first, self.second, self.agreeing, self.moments, self.lag = first, second, agreeing, moments, lag
        mend = "were the pictures taken at the same moment, by cameras fixed to each other, of one board?"
        if lag:
            mend = f"they agree when picture k of {first} goes with k{lag:+d} of {second}: rename the files"
        super().__init__(
            f"{first} and {second} put the board at the same place at {agreeing} of {moments} moments: {mend}"
        )


class TooLittleMotion(BadInput):
    """The robot's poses leave a direction unknown."""

    def __init__(self, unknown: str, why: str, mend: str):
        self.unknown, self.why = unknown, why
        super().__init__(f"{unknown} cannot be known from these poses ({why}): {mend}")


class OffPlane(BadInput):
    """A pixel sees no part of the work plane."""

    def __init__(self, name: str, pixel: tuple[float, float], why: str):
        self.name, self.pixel, self.why = name, pixel, why
        super().__init__(
            f"{name} at ({pixel[0]:.6g}, {pixel[1]:.6g}) px sees no part of the plane ({why}): leave it out"
        )


class BadCameraFile(BadInput):
    """A camera file is truncated, unknown or inconsistent."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} is not a camera file this tool can use: {why}")


class BadCornerFile(BadInput):
    """A text file of corners or board points cannot be used."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as corners: {why}")


class BadDataset(BadInput):
    """A folder is no dataset in a layout that this library reads, or an incomplete one."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as a dataset: {why}")


class BadRecipe(BadInput):
    """A recipe of a synthetic dataset cannot be used."""

    def __init__(self, recipe: object, why: str):
        self.recipe, self.why = str(recipe), why
        super().__init__(f"recipe {recipe}: {why}")


class BadTable(BadInput):
    """A table in a text file cannot be used."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as a table: {why}")


class BadPoseFile(BadInput):
    """A file of robot poses cannot be used."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as robot poses: {why}")


class TooFewPoses(BadInput):
    """Fewer usable pairs of pose and picture than a hand-eye calibration needs."""

    def __init__(self, usable: int, needed: int, given: int, why: str = ""):
        self.usable, self.needed, self.given, self.why = usable, needed, given, why
        super().__init__(
            f"{usable} usable pair(s) of pose and picture of {given} given{f' ({why})' if why else ''}: "
            f"at least {needed} are needed, ten to twenty are good; turn the wrist by 30-90 degrees about "
            "different axes"
        )


class DegeneratePoses(BadInput):
    """The arm's poses leave a part of the hand-eye transform undetermined."""

    def __init__(self, undetermined: Sequence[str], why: str, mend: str):
        self.undetermined, self.why, self.mend = tuple(undetermined), why, mend
        super().__init__(f"{'; '.join(undetermined)} cannot be known from these poses ({why}): {mend}")


class ContradictingPoses(BadInput):
    """The arm's poses and the pictures do not belong together as they are given."""

    def __init__(self, why: str, mend: str, order: Sequence[int] | None = None):
        self.why, self.mend = why, mend
        self.order = None if order is None else tuple(order)
        """For shuffled pairs: the pose that each picture fits, -1 for none."""
        super().__init__(f"the arm's poses and the pictures contradict each other: {why}; {mend}")


class BadVideo(BadInput):
    """A video cannot be read or written."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as a video: {why}")


class BadFrame(BadInput):
    """A frame does not belong into the video it was given for."""

    def __init__(self, index: int, why: str):
        self.index, self.why = index, why
        super().__init__(f"frame {index} cannot be used: {why}")


class NoColour(BadInput):
    """The first frame does not show a colour to track."""

    def __init__(self, colour: str | None = None):
        self.colour = colour
        what = f"{colour} is not in the first frame" if colour else "no colour stands out in the first frame"
        super().__init__(f"{what}: pick a point or a region of the object (see `vr track pick`)")


class BrokenPlugin(BadInput):
    """A package names something that cannot be loaded."""

    def __init__(self, name: str, package: str, target: str, why: str):
        self.name, self.package, self.target, self.why = name, package, target, why
        super().__init__(f"{name} of package {package} ({target}) cannot be loaded ({why}): mend or remove")


class BadPort(BadInput):
    """A serial port cannot be used."""

    def __init__(self, port: str, why: str, there_are: Sequence[str]):
        self.port, self.why, self.there_are = port, why, tuple(there_are)
        known = ", ".join(there_are) or "none"
        super().__init__(f"{port} cannot be used as a serial port ({why}): this machine has {known}")


class LinkMismatch(BadInput):
    """Computer and microcontroller do not speak of the same thing."""

    def __init__(self, port: str, what: str, there: object, here: object):
        self.port, self.what, self.there, self.here = port, what, there, here
        super().__init__(
            f"{port}: {what} is {there} at the microcontroller and {here} here: "
            "give the arm it was built for, or export and flash it again"
        )


class BadArm(BadInput):
    """A file describes no arm that can be solved."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} is not an arm this tool can use: {why}")


class BadGoal(BadInput):
    """A pose can be no goal of an arm."""

    def __init__(self, row: int, why: str, where: str = ""):
        self.row, self.why, self.where = row, why, where
        super().__init__(f"{where or f'goal {row}'} cannot be used: {why}")


class BadPath(BadInput):
    """No branch of an arm follows a path to its end."""

    def __init__(self, share: float, why: str):
        self.share, self.why = share, why
        super().__init__(f"the path can be followed for {100 * share:.0f} % of its way: {why}")


class MissingLimits(BadArm):
    """Joints that slide have no limits."""

    def __init__(self, path: object, joints: Sequence[str]):
        self.joints = tuple(joints)
        why = f"joint(s) {', '.join(joints)} slide without limits"
        super().__init__(path, f"{why}: write them into the file or give --limit {joints[0]}=0..0.4m")


class UnknownStructure(BadInput):
    """An arm is of no kind whose joints are known in closed form."""

    def __init__(self, joints: Sequence[str], pattern: str, reasons: dict[str, str]):
        self.joints, self.pattern, self.reasons = tuple(joints), pattern, reasons
        why = "; ".join(f"not {name}: {reason}" for name, reason in reasons.items())
        super().__init__(
            f"no closed form is known for joints {', '.join(joints)} ({pattern}): "
            f"{why or 'no kind that is known has this order of joints'}; use the numeric solver"
        )


class UnwritableOutput(BadInput):
    """An output cannot be written where it was asked for."""

    def __init__(self, path: Path | str, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"cannot write {path} ({why}): choose another place with -o")
