"""Tables are sent at their own pace, and whatever ends them early stops the arm."""

import numpy as np
import pytest

from tests.arm.compiled import CReceiver, needs_gcc
from vision_robot.arm.export_c import fingerprint
from vision_robot.arm.stream import JointTable, Link, PoseTable, play
from vision_robot.errors import BadParameter, CommandRefused
from vision_robot.geometry import SE3

pytestmark = needs_gcc


class Clock:
    """Time that passes when somebody sleeps, and a little at every look."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        self.now += 1e-4
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def opened(arm_in_c):
    receiver = CReceiver(arm_in_c)
    chain = arm_in_c.arm.chain
    link = Link(receiver, len(chain), fingerprint(chain), timeout_s=0.002)
    link.open()
    return receiver, link, chain


def table_of(chain, count: int = 11) -> JointTable:
    share = np.linspace(0.2, 0.8, count)[:, None]
    return JointTable.of(
        chain, 0.05 * np.arange(count), chain.limits[:, 0] + share * np.diff(chain.limits)[:, 0]
    )


@pytest.mark.parametrize("rate", [1.0, 0.5])
def test_rows_go_out_when_their_time_has_come(opened, rate):
    receiver, link, chain = opened
    table, clock = table_of(chain), Clock()
    late = [late_s for late_s, _ in play(link, table, rate=rate, clock=clock, sleep=clock.sleep)]
    assert [time for time, _ in receiver.moves] == [round(1e3 * t / rate) for t in table.time_s]
    assert np.allclose([q for _, q in receiver.moves], table.q, atol=1e-6)
    assert min(late) >= 0
    assert max(late) < 2e-3
    assert abs(clock.now - 100 - table.time_s[-1] / rate) < 2e-2


def test_poses_are_solved_at_the_other_end(opened):
    receiver, link, chain = opened
    table = table_of(chain)
    poses, clock = chain.base_from_tool(table.q), Clock()
    answers = [a for _, a in play(link, PoseTable(table.time_s, poses), clock=clock, sleep=clock.sleep)]
    assert [time for time, _ in receiver.moves] == [round(1e3 * t) for t in table.time_s]
    reached = chain.base_from_tool(np.array([answer.q for answer in answers]))
    assert np.abs(reached.translation - poses.translation).max() < 1e-5
    # One branch all along: the receiver solves from where it stands.
    assert np.abs(np.diff([answer.q for answer in answers], axis=0)).max() < 0.5


@pytest.mark.parametrize("time", [[0.0, 0.0], [-1.0, 0.0], [0.0, np.nan], [0.0]])
def test_bad_times_of_poses(time):
    with pytest.raises(BadParameter):
        PoseTable(np.array(time), SE3.identity(2))


def test_an_error_stops_the_arm(opened):
    receiver, link, chain = opened
    table = table_of(chain)
    table.q[4, 0] = 9
    before, clock = receiver.count("stopped"), Clock()
    with pytest.raises(CommandRefused, match="OUTSIDE_LIMITS"):
        list(play(link, table, clock=clock, sleep=clock.sleep))
    assert len(receiver.moves) == 4
    assert receiver.count("stopped") == before + 1


def test_leaving_early_stops_the_arm(opened):
    receiver, link, chain = opened
    before, clock = receiver.count("stopped"), Clock()
    playing = play(link, table_of(chain), clock=clock, sleep=clock.sleep)
    next(playing)
    playing.close()
    assert receiver.count("stopped") == before + 1
