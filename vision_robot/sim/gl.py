"""Which OpenGL MuJoCo renders with; the only place that imports mujoco for rendering.

MuJoCo reads MUJOCO_GL while it is imported and raises AttributeError there when that names a
library the machine does not have. So the libraries are asked first (`vision_robot.sim.opengl`),
in this order: what the user's MUJOCO_GL names, EGL, the system's OSMesa, the OSMesa of the PyPI
wheel lavavu-osmesa; then MuJoCo is told the first that works. On macOS and Windows MuJoCo's own
choice stands.
"""

import importlib
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import ModuleType

from vision_robot.errors import MissingOpenGL
from vision_robot.sim import opengl
from vision_robot.sim.opengl import ProbeFailed

__all__ = ["BackEnd", "choose_back_end", "load_mujoco"]

OFF = ("disable", "disabled", "off", "false", "0")
WINDOWED = ("enable", "enabled", "on", "true", "1", "glfw", "glx")
NATIVE = {"darwin": ("cgl", "glfw"), "win32": ("wgl", "glfw")}
GL_CONTEXT = "mujoco.rendering.classic.gl_context"


@dataclass(frozen=True)
class BackEnd:
    """An OpenGL that works here, and why those before it do not."""

    name: str
    """What MUJOCO_GL must say: egl, osmesa, glfw; empty for MuJoCo's own choice."""
    title: str
    """Its name for people: EGL, OSMesa, lavavu-osmesa, a window."""
    renderer: str = ""
    """Its own name for itself; empty where only a real render can ask."""
    library: Path | None = None
    """The OSMesa to open by path."""
    failed: dict[str, str] = field(default_factory=dict)
    """Those tried before it and the reason each cannot render."""


_chosen: BackEnd | None = None


def load_mujoco(*, rendering: bool = True) -> ModuleType:
    """The mujoco module, `GLContext` and `Renderer` usable; with `rendering=False` free of any OpenGL.

    Physics may be loaded first and rendering later in the same process. Raises MissingOpenGL,
    with every back end tried and the reason, where rendering is asked for and none works.
    """
    mujoco = _rendering() if rendering else _without_opengl()
    # Left to itself it writes what it warns of into MUJOCO_LOG.TXT in whatever folder it is called from.
    if mujoco.get_mju_user_warning() is None:
        mujoco.set_mju_user_warning(_unheard)
    return mujoco


def _unheard(message: str) -> None:
    """What MuJoCo warns of, our own checks say in words of the user's file."""


def _without_opengl() -> ModuleType:
    # Only while it is imported: processes started later must still see what the user chose.
    with _environment("MUJOCO_GL", "disable"):
        return importlib.import_module("mujoco")


def _rendering() -> ModuleType:
    back_end = choose_back_end()
    try:
        return _mujoco_with(back_end)
    except (ImportError, AttributeError, OSError, RuntimeError) as error:
        # The library itself renders: PyOpenGL was bound to another one earlier in this process.
        raise MissingOpenGL({**back_end.failed, back_end.title: str(error)}) from error


def choose_back_end() -> BackEnd:
    """The first OpenGL that makes a context here; found out once a process. Raises MissingOpenGL."""
    global _chosen  # noqa: PLW0603 - the answer cannot change while the process lives
    if _chosen is None:
        _chosen = _first_that_works(os.environ.get("MUJOCO_GL", "").lower().strip())
    return _chosen


def _first_that_works(asked: str) -> BackEnd:
    failed: dict[str, str] = {}
    if not sys.platform.startswith("linux"):
        native = ("", *OFF, *WINDOWED, *NATIVE.get(sys.platform, ()))
        if asked not in native or asked in OFF:
            failed[f"MUJOCO_GL={asked}"] = "it names no way to render on this system"
            asked = ""
        return BackEnd(asked, asked or "MuJoCo's own choice", failed=failed)
    attempts: list[Callable[[], BackEnd]] = [_egl, _osmesa, _osmesa_of_wheel]
    if asked == "osmesa":
        attempts = [_osmesa, _osmesa_of_wheel, _egl]
    elif asked in WINDOWED:
        attempts.insert(0, _window)
    elif asked not in ("", "egl"):
        failed[f"MUJOCO_GL={asked}"] = "it asks for no rendering" if asked in OFF else "no such back end"
    for attempt in attempts:
        try:
            return replace(attempt(), failed=failed)
        except ProbeFailed as why:
            failed[TITLES[attempt]] = str(why)
    raise MissingOpenGL(failed)


def _egl() -> BackEnd:
    return BackEnd("egl", TITLES[_egl], opengl.probe_egl())


def _osmesa() -> BackEnd:
    return BackEnd("osmesa", TITLES[_osmesa], opengl.probe_osmesa())


def _osmesa_of_wheel() -> BackEnd:
    library = opengl.wheel_osmesa()
    if library is None:
        raise ProbeFailed("not installed")
    return BackEnd("osmesa", TITLES[_osmesa_of_wheel], opengl.probe_osmesa(library), library)


def _window() -> BackEnd:
    """GLFW opens a window system's display and may abort there: another process asks."""
    script = "import mujoco as m; m.Renderer(m.MjModel.from_xml_string('<mujoco/>'), 8, 8).render()"
    environment = {**os.environ, "MUJOCO_GL": "glfw"}
    try:
        done = subprocess.run(
            [sys.executable, "-c", script], env=environment, capture_output=True, timeout=30, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ProbeFailed(str(error)) from error
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise ProbeFailed(lines[-1] if lines else f"it ended with {done.returncode}")
    return BackEnd("glfw", TITLES[_window])


TITLES: dict[Callable[[], BackEnd], str] = {
    _egl: "EGL",
    _osmesa: "OSMesa",
    _osmesa_of_wheel: opengl.OSMESA_WHEEL,
    _window: "window (GLFW)",
}


def _mujoco_with(back_end: BackEnd) -> ModuleType:
    # MuJoCo's C side reads MUJOCO_GL once more at the first context: it has to stay.
    if back_end.name:
        os.environ["MUJOCO_GL"] = back_end.name
    elif back_end.failed:
        os.environ.pop("MUJOCO_GL", None)
    if back_end.name in ("egl", "osmesa"):
        os.environ["PYOPENGL_PLATFORM"] = back_end.name
    if back_end.library is not None:
        _give_pyopengl(back_end.library)
    loaded_before = "mujoco" in sys.modules
    mujoco = importlib.import_module("mujoco")
    if loaded_before and not _renders_with(mujoco, back_end.name):
        # Imported without OpenGL, or for a window: read MUJOCO_GL again.
        mujoco.GLContext = importlib.reload(sys.modules[GL_CONTEXT]).GLContext  # type: ignore[attr-defined]
    if mujoco.GLContext.__name__ == "_MissingGLContext":
        mujoco.GLContext()  # says in an ImportError what is missing
    return mujoco


def _renders_with(mujoco: ModuleType, name: str) -> bool:
    context = getattr(mujoco, "GLContext", None)
    return context is not None and (not name or context.__module__ == f"mujoco.{name}")


def _give_pyopengl(library: Path) -> None:
    """Have PyOpenGL take this OSMesa: it looks for plain names only, so its platform is replaced.

    Platforms are a documented extension point (OpenGL/platform/__init__.py); the first of a name wins.
    """
    from OpenGL.plugins import PlatformPlugin

    opengl.open_wheel_osmesa(library)
    if not any(plugin.import_path == WHEEL_PLATFORM for plugin in PlatformPlugin.registry):
        PlatformPlugin("osmesa", WHEEL_PLATFORM)
        PlatformPlugin.registry.insert(0, PlatformPlugin.registry.pop())


WHEEL_PLATFORM = "vision_robot.sim.pyopengl_wheel.WheelOSMesaPlatform"


@contextmanager
def _environment(name: str, value: str) -> Iterator[None]:
    before = os.environ.get(name)
    os.environ[name] = value
    try:
        yield
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before
