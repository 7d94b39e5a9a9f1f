"""What other programs and devices fail in."""

from collections.abc import Sequence

from .root import BadInput, VisionRobotError


class BadPort(BadInput):
    """A serial port cannot be used."""

    def __init__(self, port: str, why: str, there_are: Sequence[str]):
        self.port, self.why, self.there_are = port, why, tuple(there_are)
        known = ", ".join(there_are) or "none"
        super().__init__(f"{port} cannot be used as a serial port ({why}): this machine has {known}")


class LinkMismatch(BadInput):
    """Computer and microcontroller do not speak of the same thing."""

    def __init__(self, port: str, what: str, there: object, here: object):
        self.port, self.what, self.there, self.here = port, what, there, here
        super().__init__(
            f"{port}: {what} is {there} at the microcontroller and {here} here: "
            "give the arm it was built for, or export and flash it again"
        )


class NoAnswer(VisionRobotError):
    """The other end of a serial line keeps silent."""

    def __init__(self, port: str, message: str, sequence: int, tries: int, timeout_s: float):
        self.port, self.message, self.sequence = port, message, sequence
        self.tries, self.timeout_s = tries, timeout_s
        super().__init__(
            f"{port}: no answer to {message} number {sequence}, sent {tries} time(s) and waited for "
            f"{1e3 * timeout_s:.0f} ms each: check cable, baud rate and that the receiver runs; "
            "whether the command was carried out is not known"
        )


class CommandRefused(VisionRobotError):
    """A microcontroller did not do what it was told, and said why."""

    def __init__(self, port: str, message: str, sequence: int, status: str, meaning: str):
        self.port, self.message, self.sequence, self.status = port, message, sequence, status
        super().__init__(f"{port}: {message} number {sequence} was refused ({status}): {meaning}")


class NoScheduler(BadInput):
    """No cluster answers where one was named."""

    def __init__(self, address: str, why: str):
        self.address, self.why = address, why
        super().__init__(f"no scheduler answers at {address} ({why}): start one with 'dask scheduler'")


class PeerFailed(VisionRobotError):
    """Another program that was to be measured ended badly."""

    def __init__(self, command: str, why: str):
        self.command, self.why = command, why
        super().__init__(f"'{command}' failed: {why}")


class NothingSeen(VisionRobotError):
    """A tracker says nothing of an object that is there."""

    def __init__(self, tracker: str, name: str):
        self.tracker, self.name = tracker, name
        super().__init__(f"tracker {tracker} does not see {name}")


class LostSight(VisionRobotError):
    """What a closed loop is guided by was not seen for too long, and what is known does not do without."""

    def __init__(self, name: str, seconds: float, sigma_m: float):
        self.name, self.seconds, self.sigma_m = name, seconds, sigma_m
        known = f", and the place is known to {1e3 * sigma_m:.1f} mm only" if sigma_m < float("inf") else ""
        super().__init__(f"{name} was out of sight for {seconds:.2g} s{known}")


class ServoAstray(VisionRobotError):
    """A closed loop did not bring its error below what it stops at."""

    def __init__(self, law: str, seconds: float, error_m: float):
        self.law, self.seconds, self.error_m = law, seconds, error_m
        super().__init__(
            f"the {law} loop did not settle in {seconds:.2g} s: {1e3 * error_m:.2g} mm are left; "
            "lower the gain, or calibrate again"
        )
