"""Everything this library raises on purpose.

One root, `VisionRobotError`; below it `BadInput` for what the caller can mend.
Every message says what is wrong, where, and how to mend it; the evidence is kept
as attributes so that a caller can act on it without parsing text.
"""

from .arms import BadArm, BadGoal, BadPath, MissingLimits, UnknownStructure, Unreachable
from .links import BadPort, CommandRefused, LinkMismatch, NoAnswer, NoScheduler, NothingSeen, PeerFailed
from .pictures import (
    BadBag,
    BadDataset,
    BadFrame,
    BadRecipe,
    BadVideo,
    MixedImageSizes,
    NoColour,
    NoImages,
    UnreadableImage,
)
from .poses import BadPoseFile, ContradictingPoses, DegeneratePoses, TooFewPoses, TooLittleMotion
from .root import (
    BadInput,
    BadParameter,
    BadTable,
    BrokenPlugin,
    MissingOpenGL,
    MissingPackage,
    NoConvergence,
    UnwritableOutput,
    VisionRobotError,
)
from .views import (
    AmbiguousPlane,
    BadCameraFile,
    BadCornerFile,
    BoardNotFound,
    DegenerateViews,
    EdgeOnPlane,
    OffPlane,
    TooFewViews,
    UnlevelBoard,
    UnlinkedCameras,
    Unsynchronised,
)

__all__ = [
    "AmbiguousPlane",
    "BadArm",
    "BadBag",
    "BadCameraFile",
    "BadCornerFile",
    "BadDataset",
    "BadFrame",
    "BadGoal",
    "BadInput",
    "BadParameter",
    "BadPath",
    "BadPort",
    "BadPoseFile",
    "BadRecipe",
    "BadTable",
    "BadVideo",
    "BoardNotFound",
    "BrokenPlugin",
    "CommandRefused",
    "ContradictingPoses",
    "DegeneratePoses",
    "DegenerateViews",
    "EdgeOnPlane",
    "LinkMismatch",
    "MissingLimits",
    "MissingOpenGL",
    "MissingPackage",
    "MixedImageSizes",
    "NoAnswer",
    "NoColour",
    "NoConvergence",
    "NoImages",
    "NoScheduler",
    "NothingSeen",
    "OffPlane",
    "PeerFailed",
    "TooFewPoses",
    "TooFewViews",
    "TooLittleMotion",
    "UnknownStructure",
    "UnlevelBoard",
    "UnlinkedCameras",
    "Unreachable",
    "UnreadableImage",
    "Unsynchronised",
    "UnwritableOutput",
    "VisionRobotError",
]
