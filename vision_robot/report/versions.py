"""Which programs made a page."""

import platform
from importlib.metadata import PackageNotFoundError, version

import vision_robot

__all__ = ["versions"]

PACKAGES = {"NumPy": "numpy", "OpenCV": "opencv-contrib-python-headless", "Matplotlib": "matplotlib"}


def versions() -> tuple[tuple[str, str], ...]:
    """Name and version of what the numbers and drawings depend on."""
    found = [("Vision Robot", vision_robot.__version__), ("Python", platform.python_version())]
    for name, package in PACKAGES.items():
        try:
            found.append((name, version(package)))
        except PackageNotFoundError:
            continue
    return tuple(found)
