"""Sending a table of commands at its own pace."""

import contextlib
import time
from collections.abc import Callable, Generator

from vision_robot.arm.stream.joint_table import JointTable
from vision_robot.arm.stream.link import Link
from vision_robot.arm.stream.messages import Answer
from vision_robot.errors import VisionRobotError

__all__ = ["play"]


def play(
    link: Link,
    table: JointTable,
    *,
    rate: float = 1.0,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> Generator[tuple[float, Answer], None, None]:
    """Send each row when its time has come; yields how late it was answered [s], and the answer.

    `rate` 0.5 plays at half speed. Whatever ends it early, an error or an interrupt, tells the
    arm to stop. `link` is open, and the table was checked against the arm's limits.
    """
    started = clock()
    try:
        for time_s, q in zip(table.time_s / rate, table.q, strict=True):
            wait = started + time_s - clock()
            if wait > 0:
                sleep(wait)
            answer = link.move(time_s, q)
            yield clock() - started - time_s, answer
    except BaseException:
        with contextlib.suppress(VisionRobotError):  # the first error is the one to be told
            link.stop()
        raise
