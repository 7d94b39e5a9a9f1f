"""Writing files so that nothing half-written is ever seen."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from vision_robot.errors import UnwritableOutput

__all__ = ["atomic_path", "check_place", "write_bytes", "write_text"]


@contextmanager
def atomic_path(path: Path | str) -> Iterator[Path]:
    """A temporary path beside `path` with the same suffix, renamed to it when the block ends well.

    On any error, an interrupt included, the temporary file is removed and what stood at
    `path` stays as it was. Raises UnwritableOutput where the place cannot be written.
    """
    target = Path(path)
    try:
        if target.is_dir():
            raise UnwritableOutput(target, "it is a folder")
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{target.stem}.", suffix=target.suffix, dir=target.parent)
    except OSError as error:
        raise UnwritableOutput(target, error.strerror or str(error)) from error
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        # mkstemp makes files private; give the result the permissions an ordinary open would.
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(target)
    except OSError as error:
        raise UnwritableOutput(target, error.strerror or str(error)) from error
    finally:
        temporary.unlink(missing_ok=True)


def check_place(path: Path | str) -> None:
    """Raise UnwritableOutput where `path` plainly cannot be written, before any work is done for it."""
    target = Path(path)
    if target.is_dir():
        raise UnwritableOutput(target, "it is a folder")
    folder = next(parent for parent in target.absolute().parents if parent.exists())
    if not folder.is_dir():
        raise UnwritableOutput(target, f"{folder} is no folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise UnwritableOutput(target, f"{folder} cannot be written to")


def write_text(path: Path | str, text: str) -> None:
    """Write text as UTF-8, whole or not at all; bytes of file names that are no text come as escapes."""
    write_bytes(path, text.encode(errors="backslashreplace"))


def write_bytes(path: Path | str, data: bytes) -> None:
    """Write bytes, whole or not at all."""
    with atomic_path(path) as temporary:
        temporary.write_bytes(data)
