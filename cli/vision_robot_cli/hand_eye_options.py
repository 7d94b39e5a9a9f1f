"""The options of `vr extrinsics hand-eye` that say what numbers mean and what is estimated."""

from dataclasses import dataclass, replace

from vision_robot.calibrate.hand_eye.pose_table import LENGTHS, PoseTable, Reading
from vision_robot.calibrate.hand_eye.rotations import is_euler_order
from vision_robot.calibrate.hand_eye.setup import setup_named
from vision_robot.errors import BadParameter

__all__ = ["HandEyeOptions"]

INTRINSICS = ("known", "fixed", "free")


@dataclass(frozen=True)
class HandEyeOptions:
    """The options that say what numbers mean and what is estimated."""

    setup: str
    rotation: str | None
    pose_unit: str | None
    angle_unit: str | None
    inverse: bool
    arm: str | None
    geometry: bool
    intrinsics: str

    def check(self, *, synthetic: bool, auto: bool, given: bool) -> None:
        """Refuse options that make no sense, before any work is done."""
        setup_named(self.setup)
        if self.intrinsics not in INTRINSICS:
            raise BadParameter("--intrinsics", self.intrinsics, " or ".join(INTRINSICS))
        if self.pose_unit is not None and self.pose_unit not in LENGTHS:
            raise BadParameter("--pose-unit", self.pose_unit, " or ".join(LENGTHS))
        if self.angle_unit not in (None, "rad", "deg"):
            raise BadParameter("--angle-unit", self.angle_unit, "rad or deg")
        known = (None, "rotvec", "matrix", "columns")
        if self.rotation not in known and not (
            sorted(self.rotation or "") == sorted("wxyz") or is_euler_order(self.rotation or "")
        ):
            allowed = (
                "wxyz, xyzw, rotvec, matrix, columns, or three axes such as xyz (fixed) or ZYX (turning)"
            )
            raise BadParameter("--rotation", self.rotation, allowed)
        if auto and not synthetic:
            raise BadParameter(
                "--auto", "without --synthetic", "given with it: the arm that drives is MuJoCo's"
            )
        if synthetic and given:
            raise BadParameter("--synthetic", "with pictures or poses", "given alone")
        if not synthetic and not given:
            raise BadParameter("pictures", None, "given with --poses and --camera; or try --synthetic")
        if self.geometry and not self.arm and not synthetic:
            raise BadParameter("--geometry", "without --arm", "given with the arm's model")

    def reading(self, table: PoseTable) -> Reading:
        """What the file's columns say, overruled by the options."""
        reading = table.reading
        width = table.turn.shape[1]
        kinds = {"rotvec": ("rotvec", 3), "matrix": ("matrix", 9), "columns": ("matrix", 9)}
        if self.rotation is not None and table.has_poses:
            name = self.rotation
            kind, wanted = kinds.get(name, ("quaternion", 4) if len(name) == 4 else ("euler", 3))
            if wanted != width:
                raise BadParameter("--rotation", name, f"one of {width} numbers, as {table.source} has")
            reading = replace(reading, kind=kind, order=name, transposed=name == "columns")
        return replace(
            reading,
            length=self.pose_unit or reading.length,
            angle=self.angle_unit or reading.angle,
            inverse=reading.inverse != self.inverse,
        )
