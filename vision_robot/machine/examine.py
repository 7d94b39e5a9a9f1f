"""The whole examination, in the order it is shown."""

from vision_robot.machine import compute, packages, rendering, videos
from vision_robot.machine.check import Check

__all__ = ["examine"]


def examine(*, full: bool = False) -> list[Check]:
    """Try everything that Vision Robot needs or can use; `full` also imports each package (10 s)."""
    checks = [*packages.system(), *packages.dependencies(full=full)]
    checks.append(rendering.check())
    checks += videos.checks()
    checks += [compute.torch_device(full=full), compute.compiler(), compute.cores()]
    return checks
