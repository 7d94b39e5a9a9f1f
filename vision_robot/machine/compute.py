"""What computes here: cores, a C compiler, a GPU for torch."""

import ctypes
import os
import shutil
import subprocess
import sys

from vision_robot.machine.check import Check, Status

__all__ = ["compiler", "cores", "torch_device"]


def cores() -> Check:
    """Cores this process may use, and the machine's memory."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    memory = ""
    if "SC_PHYS_PAGES" in os.sysconf_names:
        gigabytes = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30
        memory = f", {gigabytes:.0f} GiB of memory"
    return Check("compute", "cores", Status.OK, f"{usable}{memory}", details={"cores": usable})


def compiler() -> Check:
    """The C compiler that CasADi's generated code can be built with."""
    for name in ("cc", "gcc", "clang"):
        path = shutil.which(name)
        if path:
            told = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
            first = told.stdout.splitlines()[:1]
            return Check("compute", "C compiler", Status.OK, first[0] if first else path)
    mend = "xcode-select --install" if sys.platform == "darwin" else "apt-get install gcc libc6-dev"
    found = "none; the kinematics then run in CasADi's own interpreter, a few times slower"
    return Check("compute", "C compiler", Status.ABSENT, found, mend)


def torch_device(*, full: bool = False) -> Check:
    """Where torch would compute; its import takes seconds, so without `full` the CUDA driver is asked."""
    device = _imported_torch_device() if full else _cuda_device()
    found = device or "cpu (no CUDA driver answers)"
    return Check("compute", "torch device", Status.OK, found, details={"device": "cuda" if device else "cpu"})


def _cuda_device() -> str | None:
    try:
        cuda = ctypes.CDLL("nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1")
        count, name = ctypes.c_int(), ctypes.create_string_buffer(100)
        if cuda.cuInit(0) or cuda.cuDeviceGetCount(ctypes.byref(count)) or not count.value:
            return None
        cuda.cuDeviceGetName(name, len(name), 0)
    except (OSError, AttributeError):
        return None
    return f"cuda, {count.value} x {name.value.decode(errors='replace')}"


def _imported_torch_device() -> str | None:
    import torch

    if not torch.cuda.is_available():
        return None
    return f"cuda, {torch.cuda.device_count()} x {torch.cuda.get_device_name(0)}"
