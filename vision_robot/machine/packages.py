"""Versions: the system, Python, and every package this one depends on."""

import importlib
import importlib.metadata
import platform
import shlex
import sys

from vision_robot import __version__
from vision_robot.machine.check import Check, Status

__all__ = ["dependencies", "install_command", "system"]

# Where the module is not called like the distribution.
MODULES = {"opencv-contrib-python-headless": "cv2", "pyyaml": "yaml", "scikit-image": "skimage"}


def install_command(*what: str) -> str:
    """The command that installs into the environment that is running."""
    return shlex.join(["uv", "pip", "install", "--python", sys.executable, *what])


def system() -> list[Check]:
    """Operating system, Python, and the version of Vision Robot."""
    return [
        Check("versions", "vision-robot", Status.OK, __version__),
        Check("versions", "python", Status.OK, f"{platform.python_version()} ({sys.executable})"),
        Check("versions", "system", Status.OK, f"{platform.platform()} {platform.machine()}"),
    ]


def dependencies(*, full: bool = False) -> list[Check]:
    """Is each dependency here, in a version that is allowed? With `full`, can it be imported?"""
    from packaging.requirements import Requirement

    wanted = [Requirement(text) for text in importlib.metadata.requires("vision-robot") or []]
    return [
        _dependency(requirement.name, requirement, full=full)
        for requirement in wanted
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""})
    ]


def _dependency(name: str, requirement: object, *, full: bool) -> Check:
    from packaging.requirements import Requirement

    assert isinstance(requirement, Requirement)
    mend = install_command(str(requirement))
    try:
        version = importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return Check("packages", name, Status.BROKEN, "not installed", mend)
    if not requirement.specifier.contains(version, prereleases=True):
        return Check("packages", name, Status.BROKEN, f"{version}, {requirement.specifier} is needed", mend)
    # MuJoCo's import is part of the test render, where its OpenGL is chosen first.
    if full and name != "mujoco":
        try:
            importlib.import_module(MODULES.get(name, name))
        except Exception as error:  # a broken binary raises anything
            again = install_command("--reinstall", str(requirement))
            return Check("packages", name, Status.BROKEN, f"{version}, import fails: {error}", again)
    return Check("packages", name, Status.OK, version)
