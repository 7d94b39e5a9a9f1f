"""Over a pseudo-terminal, to a process built from the exported C; a line that spoils bytes included."""

import subprocess

import numpy as np
import pytest

from tests.arm.compiled import goals_inside, needs_gcc
from tests.arm.serial_line import Line
from vision_robot.arm.export_c import fingerprint
from vision_robot.arm.export_c.emulation import EMULATOR, available
from vision_robot.arm.stream import Link, SerialPort
from vision_robot.errors import BadPort

pytestmark = needs_gcc


@pytest.fixture(scope="module", params=["host", "cortex-m4f"])
def receiver(request, arm_in_c):
    """The command that runs the receiver: on this computer, or its Cortex-M4F code under qemu-arm."""
    if request.param == "host":
        target, command = "receiver", ["./receiver"]
    elif not available():
        pytest.skip("no arm-none-eabi-gcc, make or qemu-arm on this machine")
    else:
        target, command = "receiver.elf", [*EMULATOR, "receiver.elf"]
    subprocess.run(["make", target], cwd=arm_in_c.folder, check=True, capture_output=True)
    return command


def test_joints_and_poses_over_a_pseudo_terminal(arm_in_c, receiver):
    chain = arm_in_c.arm.chain
    q, _ = goals_inside(arm_in_c.arm, 20, seed=4)
    line = Line(receiver, arm_in_c.folder)
    with SerialPort(line.name) as port:
        link = Link(port, len(chain), fingerprint(chain), timeout_s=2.0)
        link.open()
        for k, one in enumerate(q):
            assert np.allclose(link.move(k, one).q, one, atol=1e-6)
        pose = chain.base_from_tool(q[0])
        answer = link.place(99, pose)
        assert np.linalg.norm(chain.base_from_tool(answer.q).translation - pose.translation) < 1e-5
        assert link.resent == 0
    moves = line.end()
    assert [time for time, _ in moves] == [*range(0, 20000, 1000), 99000]
    assert np.allclose([joints for _, joints in moves[:-1]], q, atol=1e-6)


def test_a_line_that_spoils_one_byte_in_a_hundred(arm_in_c, receiver):
    chain = arm_in_c.arm.chain
    q, _ = goals_inside(arm_in_c.arm, 30, seed=5)
    line = Line(receiver, arm_in_c.folder, spoilt=0.01)
    with SerialPort(line.name) as port:
        link = Link(port, len(chain), fingerprint(chain), timeout_s=0.06, tries=40)
        link.open()
        for k, one in enumerate(q):
            link.move(k, one)
        assert link.resent > 0
    moves = line.end()
    assert [time for time, _ in moves] == list(range(0, 30000, 1000))  # each once, in order
    assert np.allclose([joints for _, joints in moves], q, atol=1e-6)


def test_a_port_that_is_none_is_named():
    with pytest.raises(BadPort, match=r"/dev/none cannot be used as a serial port \(No such file"):
        SerialPort("/dev/none")
