"""One finding about the machine."""

from dataclasses import dataclass, field
from enum import Enum
from typing import Any

__all__ = ["Check", "Status"]


class Status(Enum):
    """How a check ended."""

    OK = "ok"
    ABSENT = "absent"
    """Not here, and the main job does without."""
    BROKEN = "broken"
    """Needed, and does not work."""


@dataclass(frozen=True)
class Check:
    """What was looked at, what was found, and the one command that mends it."""

    topic: str
    name: str
    status: Status
    found: str
    mend: str = ""
    details: dict[str, Any] = field(default_factory=dict)
    """The figures behind `found`, for programs."""
