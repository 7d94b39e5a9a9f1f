"""The root of all errors, and those that any room may raise."""

import re
from pathlib import Path
from typing import Any

LONGEST_MESSAGE = 2000
"""Characters; what stands in a file may be quoted in full, but not megabytes of it."""


class VisionRobotError(Exception):
    """Root of all errors of this library; its message is one line that a terminal can show."""

    def __init__(self, message: str = ""):
        super().__init__(_one_line(message))

    def __reduce__(self) -> tuple[Any, ...]:
        # Exceptions are pickled as a call with their message; ours take the evidence instead, and
        # have to come back from other processes.
        return _rebuilt, (type(self), self.args, self.__dict__)


def _one_line(text: str) -> str:
    if len(text) > LONGEST_MESSAGE:
        text = f"{text[:LONGEST_MESSAGE]} ... ({len(text)} characters)"
    text = re.sub(r"\s*[\r\n]\s*", " ", text)
    # Names and cells of strangers may hold what moves a terminal's cursor, or no character at all.
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def _rebuilt(
    cls: type[VisionRobotError], args: tuple[Any, ...], evidence: dict[str, Any]
) -> VisionRobotError:
    error = cls.__new__(cls, *args)
    error.__dict__.update(evidence)
    return error


class NoConvergence(VisionRobotError):
    """An iteration ended without reaching its tolerance."""


class MissingPackage(VisionRobotError):
    """An optional package is needed for what was asked."""

    def __init__(self, package: str, purpose: str):
        self.package, self.purpose = package, purpose
        super().__init__(f"{purpose} needs the package {package}: install it with 'pip install {package}'")


class MissingOpenGL(VisionRobotError):
    """No OpenGL back end works on this machine."""

    def __init__(self, tried: dict[str, str]):
        self.tried = tried
        reasons = "; ".join(f"{backend}: {why}" for backend, why in tried.items())
        super().__init__(
            f"no OpenGL back end can render ({reasons}): install one with "
            "'apt-get install libegl1 libgl1 libgl1-mesa-dri' or 'pip install --no-deps lavavu-osmesa'"
        )


class BadInput(VisionRobotError):
    """The caller gave something that cannot be used and can mend it."""


class BadParameter(BadInput):
    """An argument has a value outside what is allowed."""

    def __init__(self, name: str, value: object, allowed: str):
        self.name, self.value, self.allowed = name, value, allowed
        super().__init__(f"{name} is {value!r}: it must be {allowed}")


class BadTable(BadInput):
    """A table in a text file cannot be used."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as a table: {why}")


class UnwritableOutput(BadInput):
    """An output cannot be written where it was asked for."""

    def __init__(self, path: Path | str, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"cannot write {path} ({why}): choose another place with -o")


class BrokenPlugin(BadInput):
    """A package names something that cannot be loaded."""

    def __init__(self, name: str, package: str, target: str, why: str):
        self.name, self.package, self.target, self.why = name, package, target, why
        super().__init__(f"{name} of package {package} ({target}) cannot be loaded ({why}): mend or remove")
