"""What stands between an arm and its goal."""

from collections.abc import Sequence

from .root import BadInput, VisionRobotError


class BadArm(BadInput):
    """A file describes no arm that can be solved."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} is not an arm this tool can use: {why}")


class MissingLimits(BadArm):
    """Joints that slide have no limits."""

    def __init__(self, path: object, joints: Sequence[str]):
        self.joints = tuple(joints)
        why = f"joint(s) {', '.join(joints)} slide without limits"
        super().__init__(path, f"{why}: write them into the file or give --limit {joints[0]}=0..0.4m")


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


class Unreachable(VisionRobotError):
    """No joint values bring the tool to a goal."""

    def __init__(self, position_m: Sequence[float], short_m: float):
        self.position_m, self.short_m = tuple(map(float, position_m)), short_m
        where = ", ".join(f"{1000 * x:.0f}" for x in self.position_m)
        short = f"{1000 * short_m:.1f} mm are missing"
        super().__init__(f"the arm cannot reach ({where}) mm of the station: {short}")


class UnknownStructure(BadInput):
    """An arm is of no kind whose joints are known in closed form."""

    def __init__(self, joints: Sequence[str], pattern: str, reasons: dict[str, str]):
        self.joints, self.pattern, self.reasons = tuple(joints), pattern, reasons
        why = "; ".join(f"not {name}: {reason}" for name, reason in reasons.items())
        super().__init__(
            f"no closed form is known for joints {', '.join(joints)} ({pattern}): "
            f"{why or 'no kind that is known has this order of joints'}; use the numeric solver"
        )
