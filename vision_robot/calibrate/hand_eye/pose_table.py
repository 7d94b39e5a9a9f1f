"""The arm's poses as numbers of a file, and what the numbers are taken to mean."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.hand_eye.rotations import (
    MATRIX_SLACK,
    QUATERNION_SLACK,
    from_euler,
    from_matrix,
    from_quaternion,
)
from vision_robot.errors import BadPoseFile
from vision_robot.geometry import SE3, SerialChain, rotation_exp
from vision_robot.types import Array, Float

__all__ = ["LENGTHS", "PoseTable", "Reading"]

LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}


@dataclass(frozen=True)
class Reading:
    """What the numbers of a pose file mean.

    `kind` is quaternion, rotvec, euler or matrix; `order` that of the quaternion (wxyz, xyzw) or of
    the Euler angles; `inverse` that wrist_from_base stands where base_from_wrist belongs; `transposed`
    that matrices are written column by column.
    """

    kind: str
    order: str = ""
    length: str = "m"
    angle: str = "rad"
    inverse: bool = False
    transposed: bool = False

    @property
    def words(self) -> str:
        """As a person would say it."""
        turned = {
            "quaternion": f"quaternions {self.order}",
            "rotvec": f"rotation vectors in {self.angle}",
            "euler": f"Euler angles {self.order} in {self.angle}",
            "matrix": "transposed matrices" if self.transposed else "matrices",
        }[self.kind]
        end = ", wrist_from_base" if self.inverse else ""
        return f"{turned}, lengths in {self.length}{end}"


@dataclass(frozen=True)
class PoseTable:
    """One row a pose: `shift` (n, 3) and `turn` (n, 3, 4 or 9) as in the file, or joint values.

    `names` are pictures, where the file names them; `rows` says where in the file each pose stands.
    """

    source: str
    reading: Reading
    shift: Float[Array, "n 3"]
    turn: Float[Array, "n k"]
    names: tuple[str, ...] | None
    rows: tuple[str, ...]
    joints: Float[Array, "n j"] | None = None
    joint_names: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def has_poses(self) -> bool:
        """Whether the file holds poses of the wrist, not only joint values."""
        return len(self.shift) > 0

    def read_as(self, reading: Reading) -> "PoseTable":
        """The same numbers taken to mean something else."""
        return replace(self, reading=reading)

    def keeping(self, rows: Sequence[int]) -> "PoseTable":
        """Some of the rows, in that order."""
        some = np.asarray(rows, dtype=int)
        return replace(
            self,
            shift=self.shift[some] if self.has_poses else self.shift,
            turn=self.turn[some] if self.has_poses else self.turn,
            names=None if self.names is None else tuple(self.names[i] for i in some),
            rows=tuple(self.rows[i] for i in some),
            joints=None if self.joints is None else self.joints[some],
        )

    @property
    def base_from_wrist(self) -> SE3:
        """The poses under the present reading; raises BadPoseFile where numbers are no rotation."""
        reading, turn = self.reading, self.turn
        if reading.kind == "matrix":
            square = turn.reshape(-1, 3, 3)
            rotation, off = from_matrix(np.swapaxes(square, 1, 2) if reading.transposed else square)
            self._refuse(off > MATRIX_SLACK, off, "its 3x3 numbers are no rotation", MIRROR)
        elif reading.kind == "quaternion":
            rotation, off = from_quaternion(turn, reading.order)
            self._refuse(off > QUATERNION_SLACK, 1 + off, "its quaternion is not of length one", "")
        else:
            angles = np.radians(turn) if reading.angle == "deg" else turn
            rotation = from_euler(angles, reading.order) if reading.kind == "euler" else rotation_exp(angles)
        pose = SE3(rotation, self.shift * LENGTHS[reading.length])
        return pose.inverse() if reading.inverse else pose

    def _refuse(self, wrong: Array, off: Array, why: str, infinite: str) -> None:
        if not wrong.any():
            return
        i = int(np.argmax(wrong))
        size = infinite if np.isinf(off[i]) else f"off by {off[i]:.2g}"
        also = f", and {int(wrong.sum()) - 1} more like it" if wrong.sum() > 1 else ""
        raise BadPoseFile(self.source, f"{self.rows[i]}: {why}{f' ({size})' if size else ''}{also}")

    def joint_values(self, chain: SerialChain) -> Float[Array, "n j"]:
        """Joint values in the chain's order [rad or m]; raises BadPoseFile where they do not fit it."""
        if self.joints is None:
            raise BadPoseFile(self.source, "it has no joint values, which the arm's model needs")
        wanted = list(chain.joint_names)
        if set(wanted) <= set(self.joint_names):
            picked = self.joints[:, [self.joint_names.index(name) for name in wanted]]
        elif len(self.joint_names) == len(wanted):
            picked = self.joints
        else:
            raise BadPoseFile(
                self.source,
                f"it has {len(self.joint_names)} joint columns ({', '.join(self.joint_names)}), the arm's "
                f"model has {len(wanted)} ({', '.join(wanted)})",
            )
        turns = ~chain.slides
        if picked.size and np.abs(picked[:, turns]).max(initial=0) > 4 * np.pi:
            worst = float(np.abs(picked[:, turns]).max())
            raise BadPoseFile(
                self.source,
                f"a hinge stands at {worst:.4g} rad: are these degrees? name the columns such as "
                f"{wanted[-1]}_deg",
            )
        if picked.size and np.abs(picked[:, chain.slides]).max(initial=0) > 20:
            worst = float(np.abs(picked[:, chain.slides]).max())
            slide = next(name for name, slides in zip(wanted, chain.slides, strict=True) if slides)
            raise BadPoseFile(
                self.source,
                f"a slide stands at {worst:.4g} m: are these millimetres? name the column {slide}_mm",
            )
        return picked


MIRROR = "its determinant is negative: a mirror image, left-handed axes?"
