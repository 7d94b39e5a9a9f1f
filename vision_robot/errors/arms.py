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


class GripperTooNarrow(VisionRobotError):
    """Fingers do not go around a thing."""

    def __init__(self, thing: str, width_m: float, most_m: float, clearance_m: float):
        self.thing, self.width_m, self.most_m = thing, width_m, most_m
        super().__init__(
            f"the gripper is too narrow for {thing}: its narrowest side has {1000 * width_m:.0f} mm, the "
            f"fingers open to {1000 * most_m:.0f} mm and need {1000 * clearance_m:.0f} mm on each side"
        )


class InTheWay(VisionRobotError):
    """No grasp of a thing keeps clear of what lies beside it."""

    def __init__(self, thing: str, position_m: Sequence[float], room_m: float, which: int = 0):
        self.thing, self.position_m, self.room_m, self.which = thing, tuple(position_m), room_m, which
        where = ", ".join(f"{1000 * x:.0f}" for x in self.position_m[:2])
        super().__init__(f"{thing} cannot be taken: what lies at ({where}) mm of the station is in the way")


class TooLate(VisionRobotError):
    """A moving thing leaves the arm's reach before the arm is there."""

    def __init__(self, thing: str, speed_m_s: float, needed_s: float):
        self.thing, self.speed_m_s, self.needed_s = thing, speed_m_s, needed_s
        super().__init__(
            f"{thing} moves at {1000 * speed_m_s:.0f} mm/s and is out of reach again before the arm meets "
            f"it, which takes {needed_s:.1f} s"
        )
