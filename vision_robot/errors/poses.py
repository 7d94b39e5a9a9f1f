"""What poses of an arm cannot tell, or contradict."""

from collections.abc import Sequence

from .root import BadInput


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


class TooLittleMotion(BadInput):
    """The robot's poses leave a direction unknown."""

    def __init__(self, unknown: str, why: str, mend: str):
        self.unknown, self.why = unknown, why
        super().__init__(f"{unknown} cannot be known from these poses ({why}): {mend}")
