"""An arm as its file describes it: a serial chain, and what the file left open."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.resources import as_file, files
from pathlib import Path

import numpy as np

from vision_robot.errors import BadArm, BadParameter, MissingLimits
from vision_robot.geometry import SerialChain

__all__ = ["ARMS", "Arm", "read_arm"]

ARMS = {"column": "column_arm.xml"}
"""Arms that come with the library, by name; files in `vision_robot/arm/models`."""

FARTHEST_M = 1e6

Limits = Mapping[str, tuple[float, float]]


@dataclass(frozen=True)
class Arm:
    """A serial arm: its chain from base to tool, and where it comes from."""

    name: str
    chain: SerialChain
    base: str
    """What of the file is {B}."""
    tool: str
    """What of the file is {T}."""
    assumed: tuple[str, ...] = ()
    """What the file does not say and was assumed, in sentences."""
    nominal: SerialChain | None = None
    """The chain as drawn, where `chain` is the one measured on the real arm."""

    def __len__(self) -> int:
        return len(self.chain)

    @property
    def reach_m(self) -> float:
        """Sum of all link lengths from the first turning joint on: no point is farther from it."""
        chain = self.chain
        steps = np.linalg.norm(chain.link_from_joint.translation, axis=1)
        first = int(np.argmin(chain.slides)) if not chain.slides.all() else 0
        rest = float(np.sum(steps[first + 1 :]))
        slides = chain.slides & (np.arange(len(chain)) > first)
        travel = float(np.abs(chain.limits[slides]).max(axis=1).sum()) if slides.any() else 0.0
        hand = (chain.last_from_wrist @ chain.wrist_from_tool).translation
        return rest + travel + float(np.linalg.norm(hand))

    def calibrated(self, chain: SerialChain) -> "Arm":
        """The same arm with its geometry as measured; the drawn one stays as nominal."""
        if chain.joint_names != self.chain.joint_names:
            allowed = f"those of the arm, {', '.join(self.chain.joint_names)}"
            raise BadParameter("joints of the calibrated chain", chain.joint_names, allowed)
        return replace(self, chain=chain, nominal=self.nominal or self.chain)


def read_arm(
    source: Path | str,
    *,
    tool: str | None = None,
    wrist: str | None = None,
    base: str | None = None,
    limits: Limits | None = None,
) -> Arm:
    """The arm in an MJCF or URDF file, or one that comes with the library (`ARMS`).

    `tool`, `wrist` and `base` choose {T}, {W} and {B} by name: sites or bodies of an MJCF, links
    of a URDF. `limits` (least, greatest) [m or rad] by joint name stand before the file's own.
    Raises BadArm, with what in the file is in the way.
    """
    from vision_robot.arm.mjcf import read_mjcf
    from vision_robot.arm.urdf import is_urdf, read_urdf

    if str(source) in ARMS:
        with as_file(files("vision_robot.arm") / "models" / ARMS[str(source)]) as path:
            return read_arm(path, tool=tool, wrist=wrist, base=base, limits=limits)
    path = Path(source)
    if not path.is_file():
        raise BadArm(path, f"no such file, nor an arm that comes with the tool ({', '.join(ARMS)})")
    read = read_urdf if is_urdf(path) else read_mjcf
    return _with_limits(read(path, tool=tool, wrist=wrist, base=base), limits or {}, path)


def _with_limits(arm: Arm, given: Limits, path: Path) -> Arm:
    """The arm with the given limits, and a full turn where a turning joint has none at all."""
    chain = arm.chain
    unknown = [name for name in given if name not in chain.joint_names]
    if unknown:
        raise BadParameter("joint with a limit", unknown[0], f"one of {', '.join(chain.joint_names)}")
    places = (chain.link_from_joint, chain.last_from_wrist, chain.wrist_from_tool)
    if not all(np.abs(place.translation).max(initial=0) < FARTHEST_M for place in places):
        raise BadArm(path, f"a part of it is more than {FARTHEST_M:g} m away from the next")
    limits, assumed = np.array(chain.limits), []
    for i, name in enumerate(chain.joint_names):
        if name in given:
            limits[i] = given[name]
    open_ended = ~np.isfinite(limits).all(axis=1)
    if (open_ended & chain.slides).any():
        raise MissingLimits(path, [chain.joint_names[i] for i in np.flatnonzero(open_ended & chain.slides)])
    for i in np.flatnonzero(open_ended):
        limits[i] = -np.pi, np.pi
        assumed.append(f"joint {chain.joint_names[i]} has no limits in the file: -180 to 180 deg are taken")
    return replace(arm, chain=replace(chain, limits=limits), assumed=(*arm.assumed, *assumed))


def one_of(path: Path, kind: str, asked: str | None, names: Sequence[str], usual: Sequence[str]) -> str:
    """The name asked for; else the first usual one, else the only one. Raises BadArm, listing all."""
    known = [name for name in names if name]
    if asked is not None:
        if asked not in known:
            raise BadArm(path, f"it has no {kind} {asked!r}; it has {', '.join(known) or 'none'}")
        return asked
    for name in usual:
        if name in known:
            return name
    if len(known) == 1:
        return known[0]
    if not known:
        raise BadArm(path, f"it has no {kind}: mark the tool by one")
    raise BadArm(path, f"which {kind} is the tool? It has {', '.join(known)}: name one with --tool")
