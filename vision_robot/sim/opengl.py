"""Does an OpenGL library work here? Asked of the library itself, before MuJoCo is imported.

Each probe makes a context the way MuJoCo would (same attributes, no window), reads the
renderer's name and lets the context go: about 0.1 s with Mesa's software renderer. Nothing
here imports more than the standard library, so the launcher can ask as well.
"""

import ctypes
import importlib.metadata
import importlib.util
import os
from pathlib import Path
from typing import Any

__all__ = [
    "OSMESA_WHEEL",
    "ProbeFailed",
    "load_library",
    "open_wheel_osmesa",
    "probe_egl",
    "probe_osmesa",
    "wheel_osmesa",
]

OSMESA_WHEEL = "lavavu-osmesa"
"""The PyPI distribution that carries an OSMesa of its own."""

# The names PyOpenGL tries: one that only we can open would be of no use to MuJoCo.
EGL_NAMES = ("libEGL.so", "libEGL.so.1")
# Beside libEGL PyOpenGL opens the first of these, for glGetError: libegl1 alone does not bring one.
GL_NAMES = ("libOpenGL.so", "libOpenGL.so.0", "libGL.so", "libGL.so.1", "libGLESv2.so", "libGLESv2.so.2")
OSMESA_NAMES = ("libOSMesa.so", "libOSMesa.so.8", "libOSMesa.so.6")

GL_RENDERER = 0x1F01
GL_FLOAT = 0x1406
OSMESA_RGBA = 0x1908
EGL_PLATFORM_DEVICE = 0x313F
EGL_OPENGL_API = 0x30A2
# Red, green, blue and alpha 8 bits, depth 24, stencil 8, RGB buffer, pbuffer, desktop OpenGL: mujoco.egl.
EGL_ATTRIBUTES = (
    *(0x3024, 8, 0x3023, 8, 0x3022, 8, 0x3021, 8, 0x3025, 24, 0x3026, 8),
    *(0x303F, 0x308E, 0x3033, 0x0001, 0x3040, 0x0008, 0x3038),
)  # fmt: skip


class ProbeFailed(Exception):
    """The library cannot render here; the message says why."""


def load_library(names: tuple[str, ...]) -> ctypes.CDLL:
    """The first shared library of `names` that opens, its symbols visible to all. Raises ProbeFailed."""
    why = "no such library"
    for name in names:
        try:
            return ctypes.CDLL(name, ctypes.RTLD_GLOBAL)
        except OSError as error:
            why = str(error)
    raise ProbeFailed(why)


def wheel_osmesa() -> Path | None:
    """The libOSMesa inside the installed wheel `lavavu-osmesa`; None where it is not installed."""
    try:
        files = importlib.metadata.files(OSMESA_WHEEL) or []
    except importlib.metadata.PackageNotFoundError:
        return None
    for file in files:
        if file.name.startswith("libOSMesa") and ".so" in file.name:
            path = Path(str(file.locate()))
            if path.is_file():
                return path.resolve()
    return None


def open_wheel_osmesa(path: Path) -> ctypes.CDLL:
    """The wheel's OSMesa, its companions opened before it. Raises ProbeFailed.

    The wheel leaves its libraries without a search path (its own extension module opens them
    in order), but the loader takes a companion that is already open by its name.
    """
    waiting = sorted(other for other in path.parent.glob("*.so*") if other != path)
    opened = -1
    while waiting and opened:
        still = []
        for companion in waiting:
            try:
                ctypes.CDLL(str(companion), ctypes.RTLD_LOCAL)
            except OSError:
                still.append(companion)
        opened = len(waiting) - len(still)
        waiting = still
    return load_library((str(path),))


def probe_egl() -> str:
    """Name of the renderer that EGL reaches without a window. Raises ProbeFailed."""
    egl = load_library(EGL_NAMES)
    load_library(GL_NAMES)
    try:
        egl.eglGetProcAddress.restype = ctypes.c_void_p
        for function in ("eglQueryDevicesEXT", "eglGetPlatformDisplayEXT"):
            if not egl.eglGetProcAddress(function.encode()):
                raise ProbeFailed(f"{function} is missing: this EGL cannot render without a window")
        why = "it reports no device"
        for device in _egl_devices(egl):
            try:
                return _egl_renderer(egl, device)
            except ProbeFailed as failure:
                why = str(failure)
    except AttributeError as error:
        raise ProbeFailed(f"libEGL is incomplete: {error}") from error
    raise ProbeFailed(why)


def _egl_function(egl: ctypes.CDLL, name: str, result: Any, *arguments: Any) -> Any:
    address = egl.eglGetProcAddress(name.encode())
    if not address:
        raise ProbeFailed(f"{name} is missing")
    return ctypes.CFUNCTYPE(result, *arguments)(address)


def _egl_devices(egl: ctypes.CDLL) -> list[int | None]:
    query = _egl_function(
        egl,
        "eglQueryDevicesEXT",
        ctypes.c_uint,
        ctypes.c_int,
        ctypes.POINTER(ctypes.c_void_p),
        ctypes.POINTER(ctypes.c_int),
    )
    devices, count = (ctypes.c_void_p * 16)(), ctypes.c_int()
    if not query(len(devices), devices, ctypes.byref(count)):
        raise ProbeFailed("it cannot list its devices")
    found = list(devices[: count.value])
    # MuJoCo tries only this one when it is named.
    wanted = os.environ.get("MUJOCO_EGL_DEVICE_ID")
    if wanted is None:
        return found
    if not wanted.isdecimal() or int(wanted) >= len(found):
        raise ProbeFailed(f"MUJOCO_EGL_DEVICE_ID is {wanted!r} and there are {len(found)} devices")
    return [found[int(wanted)]]


def _egl_renderer(egl: ctypes.CDLL, device: int | None) -> str:
    pointer = ctypes.c_void_p
    platform_display = _egl_function(
        egl, "eglGetPlatformDisplayEXT", pointer, ctypes.c_uint, pointer, ctypes.POINTER(ctypes.c_int)
    )
    display = pointer(platform_display(EGL_PLATFORM_DEVICE, device, None))
    if not display or not egl.eglInitialize(display, None, None):
        raise ProbeFailed("its display cannot be initialised")
    attributes = (ctypes.c_int * len(EGL_ATTRIBUTES))(*EGL_ATTRIBUTES)
    config, count = pointer(), ctypes.c_int()
    egl.eglChooseConfig(display, attributes, ctypes.byref(config), 1, ctypes.byref(count))
    if count.value < 1:
        raise ProbeFailed("it offers no off-screen 24-bit depth buffer")
    if not egl.eglBindAPI(EGL_OPENGL_API):
        raise ProbeFailed("it has no desktop OpenGL")
    egl.eglCreateContext.restype = pointer
    context = pointer(egl.eglCreateContext(display, config, None, None))
    if not context:
        raise ProbeFailed("it cannot make a context")
    try:
        if not egl.eglMakeCurrent(display, None, None, context):
            raise ProbeFailed("its context cannot be made current")
        name = _egl_function(egl, "glGetString", ctypes.c_char_p, ctypes.c_uint)(GL_RENDERER)
    finally:
        egl.eglMakeCurrent(display, None, None, None)
        egl.eglDestroyContext(display, context)
        egl.eglReleaseThread()
    if not name:
        raise ProbeFailed("its context answers no question")
    return name.decode(errors="replace")


def probe_osmesa(library: Path | None = None) -> str:
    """Name of the renderer of an OSMesa: the system's, or the wheel's at `library`. Raises ProbeFailed."""
    osmesa = load_library(OSMESA_NAMES) if library is None else open_wheel_osmesa(library)
    pointer = ctypes.c_void_p
    buffer = (ctypes.c_float * (8 * 8 * 4))()
    try:
        osmesa.OSMesaCreateContextExt.restype = pointer
        osmesa.OSMesaGetProcAddress.restype = pointer
        context = pointer(osmesa.OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 0, None))
        if not context:
            raise ProbeFailed("it cannot make a context")
        try:
            if not osmesa.OSMesaMakeCurrent(context, buffer, GL_FLOAT, 8, 8):
                raise ProbeFailed("its context cannot be made current")
            address = osmesa.OSMesaGetProcAddress(b"glGetString")
            name = ctypes.CFUNCTYPE(ctypes.c_char_p, ctypes.c_uint)(address)(GL_RENDERER) if address else None
        finally:
            osmesa.OSMesaMakeCurrent(None, None, GL_FLOAT, 0, 0)
            osmesa.OSMesaDestroyContext(context)
    except AttributeError as error:
        raise ProbeFailed(f"libOSMesa is incomplete: {error}") from error
    if not name:
        raise ProbeFailed("its context answers no question")
    return name.decode(errors="replace")
