"""A PyOpenGL platform whose library is the OSMesa of the wheel lavavu-osmesa.

PyOpenGL imports this file by name while it is itself being imported (`vision_robot.sim.gl`).
"""

import ctypes

from OpenGL.platform.baseplatform import lazy_property
from OpenGL.platform.osmesa import OSMesaPlatform

from vision_robot.sim.opengl import ProbeFailed, open_wheel_osmesa, wheel_osmesa

__all__ = ["WheelOSMesaPlatform"]


class WheelOSMesaPlatform(OSMesaPlatform):
    """OSMesa from the wheel; everything else as PyOpenGL has it."""

    @lazy_property
    def GL(self) -> ctypes.CDLL:
        """The library that holds the functions of OpenGL and of OSMesa itself."""
        path = wheel_osmesa()
        if path is None:
            raise ProbeFailed("the wheel was removed while it was in use")
        return open_wheel_osmesa(path)
