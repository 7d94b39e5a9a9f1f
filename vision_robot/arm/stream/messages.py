"""What computer and microcontroller say to each other, and how it is laid out in a frame's payload.

The computer asks, the microcontroller answers each question. Lengths are in metres, angles in radians,
numbers are little-endian; reals are IEEE singles (0.03 µm at half a metre).

| kind | from | payload |
|---|---|---|
| 1 HELLO | computer | version u8, joints u8, fingerprint u32, silence u16 [ms] |
| 2 JOINTS | computer | time u32 [ms], joints f32 × n |
| 3 POSE | computer | time u32 [ms], position f32 × 3 [m], rotation vector f32 × 3 [rad] of base_from_tool |
| 4 STOP | computer | none |
| 0x81 WELCOME | microcontroller | status u8, version u8, joints u8, fingerprint u32, joints f32 × n |
| 0x82 ANSWER | microcontroller | status u8, joints f32 × n, distance f32 [m] and angle f32 [rad] to a pose |

HELLO keeps its first byte and WELCOME its first two in every version, so that both sides can tell.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from vision_robot.geometry import SE3
from vision_robot.types import Array, Float

__all__ = ["VERSION", "Answer", "Kind", "Status", "Welcome", "hello", "joints_payload", "pose_payload"]

VERSION = 1
"""Of the protocol; raised whenever a message changes its meaning."""


class Kind(IntEnum):
    """What a frame carries."""

    HELLO = 1
    JOINTS = 2
    POSE = 3
    STOP = 4
    WELCOME = 0x81
    ANSWER = 0x82


class Status(IntEnum):
    """What became of a command."""

    DONE = 0
    OUTSIDE_LIMITS = 1
    UNREACHABLE = 2
    NOT_FINITE = 3
    OUT_OF_ORDER = 4
    NO_SESSION = 5
    MALFORMED = 6
    MISMATCH = 7
    STOPPED = 8

    @property
    def meaning(self) -> str:
        """In words."""
        return MEANINGS[self]


MEANINGS = {
    Status.DONE: "done",
    Status.OUTSIDE_LIMITS: "a joint value lies outside the arm's limits; nothing was moved",
    Status.UNREACHABLE: "the arm cannot reach this pose; nothing was moved",
    Status.NOT_FINITE: "a number is not finite; nothing was moved",
    Status.OUT_OF_ORDER: "it is not the next command; nothing was moved",
    Status.NO_SESSION: "the microcontroller was started anew or has stopped, and wants a new handshake",
    Status.MALFORMED: "the message has the wrong length or an unknown kind; nothing was moved",
    Status.MISMATCH: "protocol or arm differ",
    Status.STOPPED: "stopped; a new handshake is needed to move again",
}


def hello(joints: int, fingerprint: int, silence_s: float) -> bytes:
    """Payload of HELLO; after `silence_s` without a frame the microcontroller stops (0: never)."""
    return struct.pack("<BBIH", VERSION, joints, fingerprint, round(1e3 * silence_s))


def joints_payload(time_s: float, q: Float[Array, "n"]) -> bytes:
    """Payload of JOINTS: be at `q` [m or rad] at `time_s`."""
    return struct.pack("<I", round(1e3 * time_s)) + np.asarray(q, "<f4").tobytes()


def pose_payload(time_s: float, base_from_tool: SE3) -> bytes:
    """Payload of POSE: bring the tool there at `time_s`; the microcontroller finds the joints."""
    numbers = np.concatenate([base_from_tool.translation, base_from_tool.rotvec()])
    return struct.pack("<I", round(1e3 * time_s)) + numbers.astype("<f4").tobytes()


@dataclass(frozen=True)
class Welcome:
    """The microcontroller's side of the handshake."""

    status: Status
    version: int
    joints: int
    fingerprint: int
    """Of the arm it was built for: `vision_robot.arm.export_c.fingerprint`."""
    q: Float[Array, "n"]
    """Where its joints are [m or rad]."""

    @classmethod
    def decode(cls, payload: bytes) -> "Welcome | None":
        """None where the payload has no such shape."""
        if len(payload) < 3 or payload[0] not in list(Status):
            return None
        if payload[1] != VERSION:
            return cls(Status(payload[0]), payload[1], payload[2], 0, np.zeros(0))
        if len(payload) != 7 + 4 * payload[2]:
            return None
        status, version, joints, fingerprint = struct.unpack_from("<BBBI", payload)
        return cls(Status(status), version, joints, fingerprint, _reals(payload[7:]))


@dataclass(frozen=True)
class Answer:
    """What the microcontroller did about one command."""

    status: Status
    q: Float[Array, "n"]
    """The joints that are now commanded [m or rad]."""
    position_error_m: float
    """Of a POSE: how far the tool will be from it."""
    orientation_error_rad: float
    tries: int = 1
    """How often the command had to be sent."""

    @classmethod
    def decode(cls, payload: bytes, joints: int, tries: int = 1) -> "Answer | None":
        """None where the payload has no such shape."""
        if len(payload) != 9 + 4 * joints or payload[0] not in list(Status):
            return None
        numbers = _reals(payload[1:])
        return cls(Status(payload[0]), numbers[:-2], float(numbers[-2]), float(numbers[-1]), tries)


def _reals(data: bytes) -> Float[Array, "n"]:
    return np.frombuffer(data, "<f4").astype(float)
