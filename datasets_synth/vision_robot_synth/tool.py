"""The column arm with a probe whose tip is a coloured bead, seen by two fixed cameras in MuJoCo."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib.resources import as_file, files

import numpy as np

from vision_robot.arm import read_arm
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, SerialChain
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.render import Renderer
from vision_robot.types import Array, Float, Image
from vision_robot_synth.sensor import Sensor

__all__ = ["ToolSet", "tool_set"]

CAMERAS = (
    Camera(1280, 960, 1121.3, 1112.8, 655.7, 466.4, 0, "brown5", (-0.2, 0.07, 6e-4, -4e-4, -0.01)),
    Camera(1280, 960, 1087.9, 1091.2, 632.1, 487.3, 0, "brown5", (-0.18, 0.05, -2e-4, 3e-4, 0.0)),
)
EYES = ((0.95, -0.55, 0.55), (0.75, 0.70, 0.50))
MIDDLE = (0.42, 0.0, 0.12)
TIP = (0.0062, -0.0047, 0.2134)
"""The bead's centre in the wrist's frame: a bent probe, held by nobody's drawing."""
BEAD_M = 0.005
REGION = np.array([[0.30, -0.14, 0.04], [0.52, 0.14, 0.22]])


@dataclass(frozen=True)
class ToolSet:
    """Robot poses, cameras and the truth; pictures are rendered when asked for."""

    chain: SerialChain
    joints: Float[Array, "poses 5"]
    tip: Float[Array, "3"]
    cameras: tuple[Camera, ...]
    cam_from_base: SE3
    seed: int
    sensor: Sensor = field(default_factory=Sensor)

    @property
    def base_from_wrist(self) -> SE3:
        """The robot's poses."""
        return self.chain.base_from_wrist(self.joints)

    def images(self, index: int) -> Iterator[Image]:
        """One camera's pictures in colour, the same at every call."""
        mj = load_mujoco()
        with as_file(files("vision_robot.arm") / "models" / "column_arm.xml") as path:
            spec = mj.MjSpec.from_file(str(path))
        hand = spec.body("hand")
        shaft = np.array([0.0, 0.0, 0.09])
        hand.add_geom(
            type=mj.mjtGeom.mjGEOM_CAPSULE,
            fromto=[*shaft, *(self.tip - 0.9 * BEAD_M * _unit(self.tip - shaft))],
            size=[0.0022, 0, 0],
            rgba=[0.25, 0.25, 0.27, 1],
            mass=0.01,
        )
        hand.add_geom(
            type=mj.mjtGeom.mjGEOM_SPHERE,
            pos=self.tip,
            size=[BEAD_M, 0, 0],
            rgba=[0.9, 0.1, 0.1, 1],
            mass=0.01,
        )
        spec.worldbody.add_geom(
            type=mj.mjtGeom.mjGEOM_BOX, pos=[0.45, 0, -0.02], size=[0.5, 0.6, 0.02], rgba=[0.6, 0.6, 0.58, 1]
        )
        spec.visual.headlight.ambient = [0.45, 0.45, 0.45]
        model = spec.compile()
        data = mj.MjData(model)
        names = self.chain.joint_names
        pose = self.cam_from_base[index].inverse()
        with Renderer(model, data, multisamples=0) as renderer:
            for k, q in enumerate(self.joints):
                for name, value in zip(names, q, strict=True):
                    data.joint(name).qpos[0] = value
                mj.mj_forward(model, data)
                image = renderer.render(self.cameras[index], pose)
                yield self.sensor.expose(image, np.random.default_rng([self.seed, 5, index, k]))


def tool_set(*, poses: int = 20, tilt: float = np.radians(35), seed: int = 0) -> ToolSet:
    """The arm at `poses` places over the table, its wrist pitched by up to `tilt` [rad]."""
    if poses < 4:
        raise BadParameter("poses", poses, "4 or more")
    chain = read_arm("column").chain
    tip = np.array(TIP)
    stand = [_looking(np.array(eye), np.array(MIDDLE)) for eye in EYES]
    places = SE3(np.stack([p.rotation for p in stand]), np.stack([p.translation for p in stand]))
    rng = np.random.default_rng([seed, 31])
    joints: list[np.ndarray] = []
    low, high = chain.limits.T
    while len(joints) < poses:
        q = rng.uniform(low, high)
        q[3] = rng.uniform(-tilt, tilt)
        at = chain.base_from_wrist(q).apply(tip[None])[0]
        inside = ((at > REGION[0]) & (at < REGION[1])).all()
        if inside and all(camera.sees(places[i].apply(at[None]))[0] for i, camera in enumerate(CAMERAS)):
            joints.append(q)
    return ToolSet(chain, np.array(joints), tip, CAMERAS, places, seed)


def _looking(eye: np.ndarray, target: np.ndarray) -> SE3:
    """cam_from_base of an upright camera; the base has z up."""
    forward = _unit(target - eye)
    right = _unit(np.cross(forward, [0, 0, 1.0]))
    rotation = np.stack([right, np.cross(forward, right), forward])
    return SE3(rotation, -rotation @ eye)


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)
