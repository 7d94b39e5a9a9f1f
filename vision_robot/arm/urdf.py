"""URDF: links and joints alone, so that missing meshes and unknown tags are no obstacle."""

from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from vision_robot.arm.model import Arm, one_of
from vision_robot.errors import BadArm
from vision_robot.geometry import SE3, SerialChain
from vision_robot.reading import LARGEST_TREE, number, read_bytes, xml_root
from vision_robot.types import Array, Float

__all__ = ["is_urdf", "read_urdf"]

TOOL_NAMES = ("tool", "tool0", "tcp", "ee_link", "end_effector")


def is_urdf(path: Path) -> bool:
    """Whether the file's root says it is a URDF (an MJCF's root is called mujoco)."""
    return _root(path).tag == "robot"


def _root(path: Path) -> Element:
    return xml_root(read_bytes(path, BadArm, LARGEST_TREE), path, BadArm)


def read_urdf(
    path: Path, *, tool: str | None = None, wrist: str | None = None, base: str | None = None
) -> Arm:
    """The arm of a URDF file from link `base` (the root) to link `tool`. Raises BadArm."""
    root = _root(path)
    if any(str(element.tag).startswith("{http") and "xacro" in str(element.tag) for element in root.iter()):
        raise BadArm(path, "it is a xacro, a template: expand it first with 'xacro FILE > arm.urdf'")
    links = [link.get("name", "") for link in root.findall("link")]
    above = {_link(joint, "child", path): joint for joint in root.findall("joint")}
    if len(above) < len(root.findall("joint")):
        children = [_link(joint, "child", path) for joint in root.findall("joint")]
        twice = sorted({child for child in children if children.count(child) > 1})
        raise BadArm(path, f"closed chain: link {', '.join(map(repr, twice))} hangs on more than one joint")
    carriers = {_link(joint, "parent", path) for joint in above.values()}
    ends = [link for link in links if link not in carriers]
    tool = tool if tool in links else one_of(path, "link", tool, ends if tool is None else links, TOOL_NAMES)
    base = base if base is None or base in links else one_of(path, "link", base, links, ())
    line = _line(tool, base, above, path)
    turning = [k for k, joint in enumerate(line) if joint.get("type") != "fixed"]
    if not turning:
        raise BadArm(path, f"no joint moves {tool!r}")
    found, link = [], SE3.identity()
    for k, joint in enumerate(line):
        link = link @ _origin(joint, path)
        if k in turning:
            found.append(_joint(joint, link, path))
            link = SE3.identity()
    wrist_at = _link(line[turning[-1]], "child", path)
    hand = line[turning[-1] + 1 :]
    if wrist is not None and wrist != wrist_at:
        after = [_link(joint, "child", path) for joint in hand]
        if wrist not in after:
            raise BadArm(
                path, f"{wrist!r} is no wrist: it must be fixed to the last joint, as {wrist_at!r} is"
            )
        split = after.index(wrist) + 1
    else:
        split = 0
    last_from_wrist, wrist_from_tool = SE3.identity(), SE3.identity()
    for joint in hand[:split]:
        last_from_wrist = last_from_wrist @ _origin(joint, path)
    for joint in hand[split:]:
        wrist_from_tool = wrist_from_tool @ _origin(joint, path)
    names, slides, axes, poses, limits = zip(*found, strict=True)
    chain = SerialChain(
        joint_names=names,
        slides=np.array(slides),
        axes=np.array(axes),
        link_from_joint=SE3(np.array([p.rotation for p in poses]), np.array([p.translation for p in poses])),
        last_from_wrist=last_from_wrist,
        limits=np.array(limits),
        wrist_from_tool=wrist_from_tool,
    )
    return Arm(root.get("name") or path.stem, chain, base=base or _link(line[0], "parent", path), tool=tool)


def _link(joint: Element, end: str, path: Path) -> str:
    element = joint.find(end)
    name = None if element is None else element.get("link")
    if not name:
        raise BadArm(path, f"joint {joint.get('name')!r} names no {end} link")
    return name


def _line(tool: str, base: str | None, above: dict[str, Element], path: Path) -> list[Element]:
    """Joints from the base down to the tool."""
    line, link = [], tool
    while link != base and link in above:
        line.append(above[link])
        link = _link(above[link], "parent", path)
        if len(line) > len(above):
            raise BadArm(path, f"closed chain: link {link!r} carries itself")
    if base is not None and link != base:
        raise BadArm(path, f"link {base!r} does not carry {tool!r}")
    return line[::-1]


def _joint(
    joint: Element, pose: SE3, path: Path
) -> tuple[str, bool, Float[Array, "3"], SE3, tuple[float, float]]:
    """Name, whether it slides, axis, pose and limits of a moving joint."""
    name, kind = joint.get("name") or "joint", joint.get("type")
    if kind not in ("revolute", "continuous", "prismatic"):
        raise BadArm(
            path, f"joint {name!r} is {kind!r}: only joints that slide or turn about one axis can be solved"
        )
    mimic = joint.find("mimic")
    if mimic is not None:
        raise BadArm(
            path, f"joint {name!r} follows joint {mimic.get('joint')!r}: each joint must be free by itself"
        )
    element = joint.find("axis")
    axis = _numbers(element, "xyz", (1, 0, 0), path, name)
    if not np.linalg.norm(axis) > 0:
        raise BadArm(path, f"the axis of joint {name!r} has no direction")
    limit = joint.find("limit")
    low, high = -np.inf, np.inf
    if kind != "continuous" and limit is not None and limit.get("lower") and limit.get("upper"):
        low, high = (_numbers(limit, end, (0,), path, name)[0] for end in ("lower", "upper"))
        if low > high:
            raise BadArm(path, f"the limits of joint {name!r} are {low} and {high}: the least comes first")
    return name, kind == "prismatic", axis, pose, (low, high)


def _origin(joint: Element, path: Path) -> SE3:
    """Pose of the joint in the link before it; angles are about fixed axes x, y, z in turn."""
    element, name = joint.find("origin"), joint.get("name") or "joint"
    roll, pitch, yaw = np.diag(_numbers(element, "rpy", (0, 0, 0), path, name))
    still = np.zeros(3)
    turn = SE3.from_rotvec(yaw, still) @ SE3.from_rotvec(pitch, still) @ SE3.from_rotvec(roll, still)
    return SE3(turn.rotation, _numbers(element, "xyz", (0, 0, 0), path, name))


def _numbers(
    element: Element | None, attribute: str, default: tuple[float, ...], path: Path, joint: str
) -> Float[Array, "n"]:
    text = None if element is None else element.get(attribute)
    if text is None:
        return np.array(default, dtype=float)
    numbers = np.array([number(word) for word in text.split()], dtype=float)  # None becomes NaN
    if len(numbers) != len(default) or not np.isfinite(numbers).all():
        raise BadArm(path, f"{attribute} of joint {joint!r} is {text!r}: it must be {len(default)} number(s)")
    return numbers
