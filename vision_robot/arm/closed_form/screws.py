"""A chain as the axes of its joints in the base, all joints at zero."""

from dataclasses import dataclass

import numpy as np

from vision_robot.geometry import SE3, SerialChain
from vision_robot.types import Array, Float

__all__ = ["Screws", "screws_of"]


@dataclass(frozen=True)
class Screws:
    """Directions and points of the joint axes, and the tool, in the base at q = 0.

    ``base_from_tool(q) = E_0(q_0) ... E_n-1(q_n-1) base_from_tool(0)``, E_i moving along or about axis i
    (the product of exponentials; Lynch & Park 2017, section 4.1).
    """

    names: tuple[str, ...]
    pattern: str
    """P for each joint that slides, R for each that turns."""
    axes: Float[Array, "n 3"]
    points: Float[Array, "n 3"]
    home: SE3

    def parallel(self, i: int, j: int) -> float:
        """How far axes i and j are from parallel, either way round: the sine of their angle."""
        return float(np.linalg.norm(np.cross(self.axes[i], self.axes[j])))

    def upright(self, i: int, j: int) -> float:
        """How far axes i and j are from a right angle: the cosine of their angle."""
        return float(abs(self.axes[i] @ self.axes[j]))

    def sign(self, i: int, j: int) -> float:
        """1 where parallel axes i and j point the same way, else -1."""
        return 1.0 if self.axes[i] @ self.axes[j] > 0 else -1.0

    def meeting(self, i: int, j: int) -> tuple[Float[Array, "3"], float]:
        """The point nearest to both axes, and the distance [m] between the axes there."""
        a, b = self.axes[i], self.axes[j]
        A = np.stack([a, -b], axis=1)
        s, t = np.linalg.lstsq(A, self.points[j] - self.points[i], rcond=None)[0]
        one, two = self.points[i] + s * a, self.points[j] + t * b
        return (one + two) / 2, float(np.linalg.norm(one - two))


def screws_of(chain: SerialChain) -> Screws:
    """The axes of a chain."""
    frames = chain.base_from_joints(np.zeros(len(chain)))
    return Screws(
        names=chain.joint_names,
        pattern="".join("P" if slides else "R" for slides in chain.slides),
        axes=np.array([frame.rotation @ axis for frame, axis in zip(frames, chain.axes, strict=True)]),
        points=np.array([frame.translation for frame in frames]),
        home=chain.base_from_tool(np.zeros(len(chain))),
    )
