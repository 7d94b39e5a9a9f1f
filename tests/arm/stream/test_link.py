"""Computer and receiver in C: whatever happens to the bytes, no wrong command is ever carried out."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.arm.compiled import CReceiver, goals_inside, needs_gcc
from vision_robot.arm.export_c import fingerprint
from vision_robot.arm.stream import Frame, FrameReader, Kind, Link, Status
from vision_robot.errors import BadParameter, CommandRefused, LinkMismatch, NoAnswer
from vision_robot.geometry import SE3

pytestmark = needs_gcc

COMMANDS = 6


def link_to(receiver: CReceiver, tries: int = 5, silence_s: float = 0.0) -> Link:
    chain = receiver.compiled.arm.chain
    mark = fingerprint(chain)
    return Link(receiver, len(chain), mark, timeout_s=0.002, tries=tries, silence_s=silence_s)


def single(q: np.ndarray) -> list[float]:
    return np.asarray(q, "f4").astype(float).tolist()


def test_joints_are_carried_out_and_answered(arm_in_c):
    receiver = CReceiver(arm_in_c)
    link = link_to(receiver)
    welcome = link.open()
    assert welcome.status is Status.DONE
    assert np.allclose(welcome.q, arm_in_c.arm.chain.limits.mean(axis=1))
    q, _ = goals_inside(arm_in_c.arm, 20, seed=1)
    for k, one in enumerate(q):
        answer = link.move(0.02 * k, one)
        assert answer.q.tolist() == single(one)
        assert answer.tries == 1
    assert receiver.moves == [(20 * k, single(one)) for k, one in enumerate(q)]
    assert link.resent == link.damaged == 0


def test_the_receiver_solves_for_a_pose(arm_in_c):
    """The text's way: position and orientation go to the microcontroller, which finds the joints."""
    receiver = CReceiver(arm_in_c)
    link = link_to(receiver)
    link.open()
    chain = arm_in_c.arm.chain
    q, _ = goals_inside(arm_in_c.arm, 50, seed=2)
    for k, pose in enumerate(chain.base_from_tool(q)[i] for i in range(len(q))):
        answer = link.place(float(k), pose)
        assert chain.within_limits(answer.q, slack=1e-6)
        off = pose.inverse() @ chain.base_from_tool(answer.q)
        assert np.linalg.norm(off.translation) < 1e-5
        assert np.linalg.norm(off.rotvec()) < 1e-4
        assert answer.position_error_m < 1e-5
        assert receiver.moves[-1] == (1000 * k, answer.q.tolist())


def test_the_limits_themselves_can_be_commanded(arm_in_c):
    receiver = CReceiver(arm_in_c)
    link = link_to(receiver)
    link.open()
    for side in arm_in_c.arm.chain.limits.T:
        assert np.allclose(link.move(0, side).q, side, atol=1e-6)
    low, high = arm_in_c.arm.chain.limits.T
    for _, joints in receiver.moves:
        assert (np.array(joints) >= low).all()
        assert (np.array(joints) <= high).all()


DAMAGE = st.dictionaries(
    st.integers(0, 900),
    st.sampled_from(["drop", "flip", "zero", "insert", "repeat", "replay"]) | st.integers(1, 255),
    max_size=40,
)


class Spoiler:
    """Does to the k-th byte on the line, both directions counted, what `damage` says."""

    def __init__(self, damage: dict[int, str | int]):
        self.damage, self.at, self.past = damage, 0, bytearray()

    def __call__(self, data: bytes, direction: str) -> bytes:
        out = bytearray()
        for byte in data:
            what = self.damage.get(self.at)
            self.at += 1
            self.past.append(byte)
            if what == "replay":  # all that was ever sent, either way, once more
                out += self.past
            elif isinstance(what, int):
                out.append(byte ^ what)
            else:
                out += {"drop": b"", "flip": bytes([byte ^ 1]), "zero": b"\0", "insert": bytes([byte, 0x55]),
                        "repeat": bytes([byte, byte]), None: bytes([byte])}[what]  # fmt: skip
        return bytes(out)


@settings(max_examples=150)
@given(DAMAGE, st.integers(0, 2**32 - 1))
def test_no_damage_to_the_line_moves_the_arm_wrongly(arm_in_c, damage, seed):
    """Carried out is a beginning of what was sent: in order, each once, exact; and all that was answered."""
    receiver = CReceiver(arm_in_c, Spoiler(damage))
    link = link_to(receiver, tries=8)
    q, _ = goals_inside(arm_in_c.arm, COMMANDS, seed=seed)
    wanted = [(k, single(one)) for k, one in enumerate(q)]
    answered = 0
    try:
        link.open()
        for k, one in enumerate(q):
            answer = link.move(k / 1e3, one)
            answered += 1
            assert answer.q.tolist() == single(one)
    except NoAnswer:
        assert len(damage) > 5
    assert receiver.moves == wanted[: len(receiver.moves)]
    assert answered <= len(receiver.moves) <= answered + 1


@settings(max_examples=200)
@given(st.binary(max_size=600))
def test_noise_moves_nothing(arm_in_c, noise):
    receiver = CReceiver(arm_in_c)
    link_to(receiver).open()
    receiver.write(noise)
    assert receiver.moves == []
    link = link_to(receiver)
    link.open()
    assert link.move(0, arm_in_c.arm.chain.limits.mean(axis=1)).status is Status.DONE


def test_python_and_c_read_the_same_frames(arm_in_c):
    """Frames whose checksum is right and whose content is odd are answered, and never carried out."""
    receiver, reader = CReceiver(arm_in_c), FrameReader()
    rng = np.random.default_rng(5)
    for _ in range(300):
        payload = rng.bytes(int(rng.integers(0, 60)))
        frame = Frame(
            int(rng.integers(5, 128)), int(rng.integers(1, 65536)), int(rng.integers(65536)), payload
        )
        receiver.write(frame.encode())
        (got,) = reader.feed(receiver.read(0))
        assert (got.kind, got.session, got.sequence) == (Kind.ANSWER, frame.session, frame.sequence)
        assert got.payload[0] == Status.NO_SESSION
    assert receiver.moves == []


def refused(link: Link, act) -> str:
    with pytest.raises(CommandRefused) as error:
        act(link)
    return error.value.status


def test_what_is_refused(arm_in_c):
    receiver = CReceiver(arm_in_c)
    link = link_to(receiver)
    middle = arm_in_c.arm.chain.limits.mean(axis=1)
    assert refused(link, lambda link: link.move(0, middle)) == "NO_SESSION"
    link.open()
    high = middle.copy()
    high[0] = 0.41
    assert refused(link, lambda link: link.move(0, high)) == "OUTSIDE_LIMITS"
    far = SE3(np.eye(3), np.array([3.0, 0, 0]))
    assert refused(link, lambda link: link.place(0, far)) == "UNREACHABLE"
    assert (
        refused(link, lambda link: link._command(Kind.JOINTS, struct.pack("<I5f", 0, *[np.nan] * 5)))
        == "NOT_FINITE"
    )
    assert refused(link, lambda link: link._command(Kind.JOINTS, bytes(23))) == "MALFORMED"
    assert receiver.moves == []
    assert link.move(0, middle).status is Status.DONE  # a refusal ends nothing
    link.sequence += 5
    assert refused(link, lambda link: link.move(0, middle)) == "OUT_OF_ORDER"
    assert len(receiver.moves) == 1


def test_after_stop_nothing_moves_until_the_next_handshake(arm_in_c):
    receiver = CReceiver(arm_in_c)
    link = link_to(receiver)
    link.open()
    before = receiver.count("stopped")
    assert link.stop().status is Status.STOPPED
    assert receiver.count("stopped") == before + 1
    middle = arm_in_c.arm.chain.limits.mean(axis=1)
    assert refused(link, lambda link: link.move(0, middle)) == "NO_SESSION"
    link.open()
    assert link.move(0, middle).status is Status.DONE


def test_a_microcontroller_started_anew_says_so(arm_in_c):
    receiver = CReceiver(arm_in_c)
    link = link_to(receiver)
    link.open()
    receiver.restart()
    assert refused(link, lambda link: link.move(0, arm_in_c.arm.chain.limits.mean(axis=1))) == "NO_SESSION"


def test_silence_stops_the_arm(arm_in_c):
    receiver = CReceiver(arm_in_c)
    link = link_to(receiver, silence_s=0.2)
    link.open()
    before = receiver.count("stopped")
    middle = arm_in_c.arm.chain.limits.mean(axis=1)
    for _ in range(5):
        receiver.elapsed(150)
        link.move(0, middle)
    assert receiver.count("stopped") == before
    receiver.elapsed(150)
    receiver.elapsed(60)
    assert receiver.count("stopped") == before + 1
    assert refused(link, lambda link: link.move(0, middle)) == "NO_SESSION"
    patient = link_to(receiver)
    patient.open()
    receiver.elapsed(10**6)
    assert patient.move(0, middle).status is Status.DONE


def test_another_arm_or_protocol_is_refused(arm_in_c):
    receiver = CReceiver(arm_in_c)
    with pytest.raises(LinkMismatch, match=r"fingerprint is .* export and flash"):
        Link(receiver, 5, 12345, timeout_s=0.002).open()
    with pytest.raises(LinkMismatch, match="number of joints is 5 at the microcontroller and 6 here"):
        Link(receiver, 6, 12345, timeout_s=0.002).open()
    receiver.write(Frame(Kind.HELLO, 9, 0, bytes([99, 5, 0, 0, 0, 0, 0, 0])).encode())
    (got,) = FrameReader().feed(receiver.read(0))
    assert (got.kind, got.payload[0]) == (Kind.WELCOME, Status.MISMATCH)
    assert receiver.moves == []


def test_a_silent_line_is_named(arm_in_c):
    receiver = CReceiver(arm_in_c, lambda data, way: b"")
    with pytest.raises(NoAnswer, match="no answer to HELLO number 0, sent 3 time"):
        link_to(receiver, tries=3).open()


@pytest.mark.parametrize("q", [[0.0] * 4, [np.nan] * 5])
def test_bad_joints_never_leave(arm_in_c, q):
    receiver = CReceiver(arm_in_c)
    link = link_to(receiver)
    link.open()
    with pytest.raises(BadParameter):
        link.move(0, np.array(q))
    with pytest.raises(BadParameter, match="time of a command"):
        link.move(-1, arm_in_c.arm.chain.limits.mean(axis=1))
    assert receiver.moves == []


def test_sequence_numbers_run_past_their_end(arm_in_c):
    receiver = CReceiver(arm_in_c)
    link = link_to(receiver)
    link.open()
    middle = arm_in_c.arm.chain.limits.mean(axis=1)
    receiver.library.link_at(receiver.state, 65530)
    link.sequence = 65530
    for _ in range(10):
        link.move(0, middle)
    assert link.sequence == 4
    assert len(receiver.moves) == 10
