"""Sending a table of commands at its own pace."""

import contextlib
import time
from collections.abc import Callable, Generator

from vision_robot.arm.stream.joint_table import JointTable
from vision_robot.arm.stream.link import Link
from vision_robot.arm.stream.messages import Answer
from vision_robot.arm.stream.pose_table import PoseTable
from vision_robot.errors import VisionRobotError

__all__ = ["play"]


def play(
    link: Link,
    table: JointTable | PoseTable,
    *,
    rate: float = 1.0,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> Generator[tuple[float, Answer], None, None]:
    """Send each row when its time has come; yields how late it was answered [s], and the answer.

    `rate` 0.5 plays at half speed. Joints are carried out as they are, poses solved at the other end.
    Whatever ends it early, an error or an interrupt, tells the arm to stop. `link` is open, and a table
    of joints was checked against the arm's limits.
    """
    started = clock()
    try:
        for k, time_s in enumerate((table.time_s / rate).tolist()):
            wait = started + time_s - clock()
            if wait > 0:
                sleep(wait)
            if isinstance(table, JointTable):
                answer = link.move(time_s, table.q[k])
            else:
                answer = link.place(time_s, table.base_from_tool[k])
            yield clock() - started - time_s, answer
    except BaseException:
        with contextlib.suppress(VisionRobotError):  # the first error is the one to be told
            link.stop()
        raise
