"""Proves that rendering finds an OpenGL that works, in the promised order, or says why not."""

import importlib.metadata
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from vision_robot.errors import MissingOpenGL
from vision_robot.sim import gl, opengl
from vision_robot.sim.opengl import ProbeFailed

linux = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="other systems bring their own OpenGL"
)

# Libraries whose name holds a word of HIDDEN cannot be opened, neither by us nor by PyOpenGL.
HIDE = """
import ctypes, os, sys
sys.path += [os.environ["EXTRA"]] if "EXTRA" in os.environ else []
hidden, open_library = os.environ.get("HIDDEN", "").split(), ctypes.CDLL.__init__
def opened(self, name, *args, **kwargs):
    if any(word in str(name) for word in hidden):
        raise OSError(f"{name}: cannot open shared object file")
    open_library(self, name, *args, **kwargs)
ctypes.CDLL.__init__ = opened
from vision_robot.sim.gl import choose_back_end, load_mujoco
"""
RENDER = """
def render(mj):
    model = mj.MjModel.from_xml_string(
        '<mujoco><visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual><worldbody>'
        '<geom type="box" size=".5 .5 .5" rgba="1 0 0 1"/><camera name="c" pos="0 0 2"/>'
        '</worldbody></mujoco>')
    data = mj.MjData(model)
    mj.mj_forward(model, data)
    with mj.Renderer(model, 48, 64) as renderer:
        renderer.update_scene(data, "c")
        red, green, blue = renderer.render()[24, 32]
    return red > 100 and green < 50 and blue < 50
"""


def in_fresh_process(script: str, **environment: str) -> subprocess.CompletedProcess[str]:
    kept = {k: v for k, v in os.environ.items() if k not in ("MUJOCO_GL", "PYOPENGL_PLATFORM")}
    return subprocess.run(
        [sys.executable, "-c", HIDE + RENDER + script],
        env={**kept, **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.fixture
def probes(monkeypatch):
    """Every probe under the test's control; a probe that is not set fails."""

    def fail(name):
        def probe(*_):
            raise ProbeFailed(f"no {name} here")

        return probe

    def works(*names):
        for name in names:
            monkeypatch.setattr(opengl, f"probe_{name}", lambda *_: "soft")

    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(opengl, "probe_egl", fail("EGL"))
    monkeypatch.setattr(opengl, "probe_osmesa", fail("OSMesa"))
    monkeypatch.setattr(opengl, "wheel_osmesa", lambda: None)
    return works


def test_egl_is_first(probes):
    probes("egl", "osmesa")
    assert gl._first_that_works("").title == "EGL"


def test_then_the_systems_osmesa(probes):
    probes("osmesa")
    found = gl._first_that_works("")
    assert (found.title, found.name, found.library) == ("OSMesa", "osmesa", None)
    assert found.failed == {"EGL": "no EGL here"}


def test_then_the_wheel(probes, monkeypatch):
    library = Path("libOSMesa.so")

    def only_the_wheel(path=None):
        if path is None:
            raise ProbeFailed("no OSMesa here")
        return "soft"

    monkeypatch.setattr(opengl, "wheel_osmesa", lambda: library)
    monkeypatch.setattr(opengl, "probe_osmesa", only_the_wheel)
    found = gl._first_that_works("")
    assert (found.title, found.name, found.library) == ("lavavu-osmesa", "osmesa", library)
    assert list(found.failed) == ["EGL", "OSMesa"]


def test_then_nothing_and_the_error_names_all_and_the_cure(probes):
    with pytest.raises(MissingOpenGL) as caught:
        gl._first_that_works("")
    assert caught.value.tried == {
        "EGL": "no EGL here",
        "OSMesa": "no OSMesa here",
        "lavavu-osmesa": "not installed",
    }
    assert "apt-get install" in str(caught.value)


@pytest.mark.parametrize(
    ("asked", "working", "title", "failed"),
    [
        ("osmesa", ("egl", "osmesa"), "OSMesa", []),
        ("osmesa", ("egl",), "EGL", ["OSMesa", "lavavu-osmesa"]),
        ("egl", ("osmesa",), "OSMesa", ["EGL"]),
        ("disable", ("egl",), "EGL", ["MUJOCO_GL=disable"]),
        ("vulkan", ("egl",), "EGL", ["MUJOCO_GL=vulkan"]),
    ],
)
def test_the_users_choice_comes_first_and_is_not_fatal(probes, asked, working, title, failed):
    probes(*working)
    found = gl._first_that_works(asked)
    assert (found.title, list(found.failed)) == (title, failed)


@pytest.mark.parametrize("system", ["darwin", "win32"])
def test_elsewhere_mujoco_chooses(monkeypatch, system):
    monkeypatch.setattr(sys, "platform", system)
    assert gl._first_that_works("") == gl.BackEnd("", "MuJoCo's own choice")
    wrong = gl._first_that_works("egl")
    assert wrong.name == ""
    assert list(wrong.failed) == ["MUJOCO_GL=egl"]


@linux
@pytest.mark.parametrize("asked", ["egl", "osmesa", "", "nonsense"])
def test_no_user_sees_an_attribute_error_from_mujoco(asked):
    """With MUJOCO_GL=egl and no libEGL, `import mujoco` itself would raise it."""
    script = """
from vision_robot.errors import MissingOpenGL
try:
    load_mujoco()
except MissingOpenGL as error:
    print("missing", *error.tried, sep=",")
print(load_mujoco(rendering=False).MjModel.from_xml_string("<mujoco/>").nbody)
"""
    ended = in_fresh_process(script, HIDDEN="libEGL libOSMesa", MUJOCO_GL=asked)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.startswith("missing,")
    assert "EGL" in ended.stdout
    assert ended.stdout.endswith("\n1\n")
    assert "AttributeError" not in ended.stderr


@linux
def test_rendering_after_physics_in_one_process():
    try:
        gl.choose_back_end()
    except MissingOpenGL as missing:
        pytest.skip(str(missing))
    script = """
before = dict(os.environ)
physics = load_mujoco(rendering=False)
assert dict(os.environ) == before, "children must see the user's choice"
assert not hasattr(physics, "GLContext")
print(render(load_mujoco()), load_mujoco() is physics)
"""
    ended = in_fresh_process(script)
    assert ended.stdout == "True True\n", ended.stderr


@linux
def test_an_egl_without_devices_is_passed_over():
    """The library opens, and every call to it answers, but no context can be made."""
    try:
        opengl.load_library(opengl.EGL_NAMES)
    except ProbeFailed as why:
        pytest.skip(f"no libEGL: {why}")
    script = """
from vision_robot.errors import MissingOpenGL
try:
    print(choose_back_end().failed["EGL"])
except MissingOpenGL as error:
    print(error.tried["EGL"])
"""
    for cause in ({"__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent.json"}, {"MUJOCO_EGL_DEVICE_ID": "99"}):
        ended = in_fresh_process(script, MUJOCO_GL="egl", **cause)
        assert ended.returncode == 0, ended.stderr
        assert ended.stdout.strip(), cause


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> str:
    """A folder with lavavu-osmesa; downloaded where it is not installed."""
    try:
        importlib.metadata.version(opengl.OSMESA_WHEEL)
    except importlib.metadata.PackageNotFoundError:
        pass
    else:
        return ""
    uv = shutil.which("uv") or shutil.which("uv", path=str(Path(sys.executable).parent))
    command = [uv, "pip"] if uv else [sys.executable, "-m", "pip", "--quiet"]
    folder = tmp_path_factory.mktemp("wheel")
    install = [*command, "install", "--no-deps", "--target", str(folder), opengl.OSMESA_WHEEL]
    trust = {**os.environ, "UV_SYSTEM_CERTS": "1"}
    ended = subprocess.run(install, env=trust, capture_output=True, text=True, timeout=300, check=False)
    if ended.returncode:
        pytest.skip(f"{opengl.OSMESA_WHEEL} cannot be installed: {ended.stderr.strip().splitlines()[-1:]}")
    return str(folder)


@linux
@pytest.mark.parametrize("physics_first", [False, True])
def test_the_wheel_renders_without_any_system_opengl(wheel, physics_first):
    script = "load_mujoco(rendering=False)\n" if physics_first else ""
    script += "print(choose_back_end().title, render(load_mujoco()))"
    hidden = "libEGL libOSMesa.so libGL libOpenGL"
    ended = in_fresh_process(script, HIDDEN=hidden, MUJOCO_GL="egl", **({"EXTRA": wheel} if wheel else {}))
    assert ended.stdout == "lavavu-osmesa True\n", ended.stderr
