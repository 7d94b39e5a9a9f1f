"""The computer's end of the line: one command at a time, sent again until it is answered."""

import secrets
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol, TypeVar

import numpy as np

from vision_robot.arm.stream.frame import Frame, FrameReader
from vision_robot.arm.stream.messages import (
    VERSION,
    Answer,
    Kind,
    Status,
    Welcome,
    hello,
    joints_payload,
    pose_payload,
)
from vision_robot.errors import BadParameter, CommandRefused, LinkMismatch, NoAnswer
from vision_robot.geometry import SE3
from vision_robot.types import Array, Float

__all__ = ["Link", "Port"]

Reply = TypeVar("Reply")


class Port(Protocol):
    """A line that carries bytes, such as `SerialPort`."""

    name: str

    def read(self, timeout_s: float) -> bytes:
        """What has arrived; waits up to `timeout_s` [s] for the first byte."""
        ...

    def write(self, data: bytes) -> None:
        """Send all of it."""
        ...


class Link:
    """A session with one microcontroller, opened by `open`.

    A command is answered before the next is sent, so at most one is ever under way. A command
    whose answer is lost is sent again with the same number, which the other end answers from memory
    without moving twice.
    """

    def __init__(
        self,
        port: Port,
        joints: int,
        fingerprint: int,
        *,
        timeout_s: float = 0.1,
        tries: int = 5,
        silence_s: float = 0.0,
    ):
        if not (timeout_s > 0 and tries >= 1):
            raise BadParameter("timeout and tries of a link", (timeout_s, tries), "above 0 and at least 1")
        if not 0 <= silence_s <= 65:
            raise BadParameter("silence of a link", silence_s, "0 (never) to 65 s")
        self.port, self.joints, self.fingerprint = port, joints, fingerprint
        self.timeout_s, self.tries, self.silence_s = timeout_s, tries, silence_s
        self.session = self.sequence = 0
        self.resent = 0
        self._reader = FrameReader()

    @property
    def damaged(self) -> int:
        """Frames that arrived damaged here."""
        return self._reader.damaged

    def open(self) -> Welcome:
        """Shake hands. Raises NoAnswer, or LinkMismatch where protocol or arm differ."""
        # A new number each time, so that nothing of an earlier session counts in this one; zero means none.
        self.session, self.sequence = 1 + secrets.randbelow(0xFFFF), 0
        payload = hello(self.joints, self.fingerprint, self.silence_s)
        frame, _ = self._ask(
            Frame(Kind.HELLO, self.session, 0, payload),
            lambda f: Welcome.decode(f.payload) if f.kind == Kind.WELCOME else None,
        )
        if frame.version != VERSION:
            raise LinkMismatch(self.port.name, "the protocol's version", frame.version, VERSION)
        if frame.joints != self.joints:
            raise LinkMismatch(self.port.name, "the number of joints", frame.joints, self.joints)
        if frame.fingerprint != self.fingerprint or frame.status != Status.DONE:
            there, here = f"{frame.fingerprint:08x}", f"{self.fingerprint:08x}"
            raise LinkMismatch(self.port.name, "the arm's fingerprint", there, here)
        return frame

    def move(self, time_s: float, q: Float[Array, "n"]) -> Answer:
        """Command joints [m or rad] for `time_s` after the stream's start."""
        q = np.asarray(q, dtype=float)
        if q.shape != (self.joints,) or not np.isfinite(q).all():
            raise BadParameter("joint values to send", q.tolist(), f"{self.joints} finite numbers")
        return self._command(Kind.JOINTS, joints_payload(_sendable(time_s), q))

    def place(self, time_s: float, base_from_tool: SE3) -> Answer:
        """Command a pose of the tool; the microcontroller solves for the joints and answers with them."""
        if base_from_tool.batch:
            raise BadParameter("poses to send", base_from_tool.batch, "one at a time")
        return self._command(Kind.POSE, pose_payload(_sendable(time_s), base_from_tool))

    def stop(self) -> Answer:
        """Stop at once, whatever the session; moving again needs `open`."""
        return self._command(Kind.STOP, b"")

    def _command(self, kind: Kind, payload: bytes) -> Answer:
        self.sequence = (self.sequence + 1) & 0xFFFF
        frame = Frame(kind, self.session, self.sequence, payload)
        answer, tries = self._ask(
            frame, lambda f: Answer.decode(f.payload, self.joints) if f.kind == Kind.ANSWER else None
        )
        expected = Status.STOPPED if kind == Kind.STOP else Status.DONE
        if answer.status != expected:
            raise CommandRefused(
                self.port.name, kind.name, self.sequence, answer.status.name, answer.status.meaning
            )
        return replace(answer, tries=tries)

    def _ask(self, frame: Frame, read: Callable[[Frame], Reply | None]) -> tuple[Reply, int]:
        """The reply to `frame`, which is sent again as long as none comes, and how often it was sent."""
        for attempt in range(1, self.tries + 1):
            self.port.write(frame.encode())
            self.resent += attempt > 1
            until = time.monotonic() + self.timeout_s
            while (left := until - time.monotonic()) > 0:
                for got in self._reader.feed(self.port.read(left)):
                    mine = (got.session, got.sequence) == (frame.session, frame.sequence)
                    reply = read(got) if mine else None
                    if reply is not None:
                        return reply, attempt
        raise NoAnswer(self.port.name, Kind(frame.kind).name, frame.sequence, self.tries, self.timeout_s)


def _sendable(time_s: float) -> float:
    if not 0 <= time_s < 2**32 / 1e3:
        raise BadParameter("time of a command", time_s, "0 to 4294967 s after the stream's start")
    return time_s
