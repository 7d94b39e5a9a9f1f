"""C made into a library once, and kept: by what is in it, the compiler and the processor."""

import ctypes
import hashlib
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

from vision_robot.errors import UnwritableOutput
from vision_robot.files import atomic_path

__all__ = ["cache_folder", "find_compiler", "load_library"]

FLAGS = (
    "-O3",
    "-march=native",
    "-fno-math-errno",
    "-ffp-contract=fast",
    "-std=gnu11",
    "-shared",
    "-fPIC",
    "-w",
)


def find_compiler() -> str | None:
    """The C compiler: what CC names, else cc, gcc or clang; None where there is none."""
    for name in (os.environ.get("CC", ""), "cc", "gcc", "clang"):
        path = shutil.which(name) if name else None
        if path:
            return path
    return None


def cache_folder() -> Path:
    """Where this user's programs keep what they can make again."""
    if sys.platform == "win32":
        root = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData/Local"
    elif sys.platform == "darwin":
        root = Path.home() / "Library/Caches"
    else:
        root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(root) / "vision-robot"


def load_library(source: str, folder: Path | None = None) -> ctypes.CDLL | None:
    """The library compiled from `source`, or None where that cannot be done here.

    A compiler may be missing, may not know vector types, or the cache may not be writable: callers then
    do without.
    """
    compiler = find_compiler()
    if compiler is None:
        return None
    path = (
        folder or cache_folder()
    ) / f"arm-{_key(source, compiler)}{'.dll' if sys.platform == 'win32' else '.so'}"
    try:
        if not path.exists():
            with atomic_path(path) as made:
                command = [compiler, *FLAGS, "-x", "c", "-", "-o", str(made), "-lm"]
                subprocess.run(command, input=source.encode(), check=True, capture_output=True, timeout=300)
        return ctypes.CDLL(str(path))
    except (OSError, UnwritableOutput, subprocess.SubprocessError):
        return None


def _key(source: str, compiler: str) -> str:
    """Content hash; -march=native makes the processor part of the content."""
    text = "\n".join([source, *FLAGS, str(Path(compiler).resolve()), platform.machine(), _processor()])
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line for line in lines if line.startswith(("flags", "Features"))), platform.processor())
