"""A serial line or pseudo-terminal as a `Port`."""

from types import TracebackType
from typing import Self

from vision_robot.errors import BadPort

__all__ = ["SerialPort"]


class SerialPort:
    """Eight data bits, no parity, one stop bit; closes itself at the end of a `with` block."""

    def __init__(self, name: str, baud: int = 115200):
        """Open `name`, such as /dev/ttyACM0 or COM3. Raises BadPort, naming the ports there are."""
        import serial

        self.name = name
        try:
            self._serial = serial.serial_for_url(name, baudrate=baud, timeout=0, write_timeout=2.0)
        except (serial.SerialException, ValueError, OSError) as error:
            raise BadPort(name, _reason(error), ports()) from error

    def read(self, timeout_s: float) -> bytes:
        """What has arrived; waits up to `timeout_s` for the first byte."""
        import serial

        try:
            self._serial.timeout = timeout_s
            first = self._serial.read(1)
            return first + self._serial.read(self._serial.in_waiting) if first else first
        except (serial.SerialException, OSError) as error:
            raise BadPort(self.name, _reason(error), ports()) from error

    def write(self, data: bytes) -> None:
        """Send all of it."""
        import serial

        try:
            self._serial.write(data)
        except (serial.SerialException, OSError) as error:
            raise BadPort(self.name, _reason(error), ports()) from error

    def close(self) -> None:
        """Give the line back."""
        self._serial.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def ports() -> list[str]:
    """The serial lines of this machine."""
    from serial.tools.list_ports import comports

    return sorted(port.device for port in comports())


def _reason(error: Exception) -> str:
    import os

    number = getattr(error, "errno", None)
    return os.strerror(number) if number else str(error)
