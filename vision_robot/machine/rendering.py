"""A test render: does MuJoCo draw the right picture here, with which OpenGL, how fast?"""

import shutil
import statistics
import time
from types import ModuleType
from typing import Any

from vision_robot.errors import MissingOpenGL
from vision_robot.machine.apart import Crashed, apart
from vision_robot.machine.check import Check, Status
from vision_robot.machine.packages import install_command
from vision_robot.sim.opengl import OSMESA_WHEEL
from vision_robot.types import Image

__all__ = ["check"]

# A red square in front of the camera, as wide as half the picture is high, on black.
SCENE = """
<mujoco>
  <visual><global offwidth="640" offheight="480"/><headlight ambient="1 1 1" diffuse="0 0 0"/></visual>
  <worldbody>
    <geom type="box" size=".5 .5 .1" rgba="1 0 0 1"/>
    <camera name="above" pos="0 0 2" fovy="60"/>
  </worldbody>
</mujoco>
"""
FRAMES = 9


def check() -> Check:
    """The OpenGL that was chosen, its test render, and why those before it were not taken."""
    try:
        answer = apart(trial_render)
    except Crashed as crash:
        answer = {"failed": {"test render": str(crash)}}
    failed = "".join(f"; {name}: {why}" for name, why in answer["failed"].items())
    if "ms_per_frame" not in answer:
        return Check("opengl", "render", Status.BROKEN, f"nothing renders{failed}", _mend(), answer)
    drawn = f"{answer['back_end']}, {answer['renderer'] or 'unnamed renderer'}"
    if not answer["right"]:
        found = f"{drawn} draws a wrong picture{failed}"
        return Check("opengl", "render", Status.BROKEN, found, _mend(), answer)
    found = f"{drawn}, {answer['ms_per_frame']:.0f} ms a frame of 640x480{failed}"
    return Check("opengl", "render", Status.OK, found, details=answer)


def trial_render() -> dict[str, Any]:
    """Render SCENE: back end, renderer, ms per frame (median), whether the picture is right, what failed."""
    from vision_robot.sim.gl import choose_back_end, load_mujoco

    try:
        back_end = choose_back_end()
        answer = {"back_end": back_end.title, "renderer": back_end.renderer, "failed": back_end.failed}
        pictures, seconds = _frames(load_mujoco())
    except MissingOpenGL as error:
        return {"failed": error.tried}
    except Exception as error:  # whatever a driver raises is the finding
        return {"failed": {"test render": f"{type(error).__name__}: {error}"}}
    middle, corner = pictures[-1][240, 320], pictures[-1][10, 10]
    right = bool(middle[0] > 100 and middle[1] < 100 and corner.max() < 30)
    return {**answer, "ms_per_frame": round(1e3 * statistics.median(seconds), 2), "right": right}


def _frames(mujoco: ModuleType) -> tuple[list[Image], list[float]]:
    model = mujoco.MjModel.from_xml_string(SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    pictures, seconds = [], []
    with mujoco.Renderer(model, 480, 640) as renderer:
        for _ in range(FRAMES):
            start = time.perf_counter()
            renderer.update_scene(data, "above")
            pictures.append(renderer.render())
            seconds.append(time.perf_counter() - start)
    return pictures, seconds


def _mend() -> str:
    if shutil.which("apt-get"):
        return "apt-get install libegl1 libgl1 libgl1-mesa-dri"
    return install_command("--no-deps", OSMESA_WHEEL)
