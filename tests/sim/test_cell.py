"""A cell behaves: things rest, roll, are pushed, carried, grasped; the arm goes where its servos are told."""

import numpy as np
import pytest

from tests.tool_down import tool_down
from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import ArmMount, Belt, CellDesign, Item, Table
from vision_robot.sim.cell_model import BACKGROUND, COLLIDERS, FIXED, MOVING
from vision_robot.sim.paths import Circle, Straight

SKEWED = SE3.from_rotvec(np.array([0, 0, 0.7]), np.array([0.33, -0.05, 0.07]))
KINDS = {
    "pencil": (0.14, 0.008),
    "rod": (0.14, 0.008),
    "hexagon": (0.12, 0.01),
    "box": (0.03, 0.04, 0.02),
    "disc": (0.05, 0.008),
}


def test_everything_comes_to_rest_where_it_lies():
    """Dropped from 0 to 20 mm, after 2 s nothing moves: < 0.1 mm/s, sunk in by < 0.1 mm."""
    items = [
        Item(
            f"{shape}{i}",
            shape,
            size,
            x_m=0.1 * k - 0.2,
            y_m=0.18 * i - 0.18,
            yaw_rad=k + i,
            above_m=0.01 * i,
        )
        for k, (shape, size) in enumerate(KINDS.items())
        for i in range(3)
    ]
    cell = Cell(CellDesign(items=tuple(items)))
    cell.advance(2.0)
    for item in items:
        place = cell.station_from(item.name)
        assert np.abs(cell.velocity(item.name)[:3]).max() < 1e-4, item.name
        thickness = item.size_m[1] if item.shape in ("pencil", "rod", "hexagon") else item.size_m[-1]
        assert -1e-4 < place.translation[2] - thickness / 2 < 1e-5, item.name
        assert np.hypot(place.translation[0] - item.x_m, place.translation[1] - item.y_m) < 2e-3, item.name


def test_a_round_rod_rolls_and_a_pencil_does_not():
    """Rolling: turning rate times radius is speed; it stops by itself after some centimetres."""
    push = np.array([0, 0.2, 0, -0.2 / 0.004, 0, 0])
    rod, pencil = (Cell(CellDesign(items=(Item("a", shape),))) for shape in ("rod", "pencil"))
    for cell, velocity in ((rod, push), (pencil, push * [0, 1, 0, 0, 0, 0])):
        cell.place("a", cell.station_from("a"), velocity)
        assert np.allclose(cell.velocity("a"), velocity)
        cell.advance(0.2)
    v = rod.velocity("a")
    assert 0.08 < v[1] < 0.18
    assert v[3] * -0.004 == pytest.approx(v[1], rel=0.01)
    rod.advance(1.5)
    assert 0.03 < rod.station_from("a").translation[1] < 0.15
    assert np.abs(rod.velocity("a")).max() < 1e-3
    assert pencil.station_from("a").translation[1] < 0.01


def test_what_has_a_path_pushes_what_has_none():
    mover = Item("mover", "box", (0.03, 0.03, 0.03), path=Straight((0, -0.06, 0, 0), (0, 0.05, 0, 0)))
    cell = Cell(CellDesign(items=(Item("rod", "rod"), mover)))
    cell.advance(2.0)
    assert cell.station_from("mover").translation[1] == pytest.approx(0.04)
    assert cell.station_from("rod").translation[1] > 0.05
    assert cell.velocity("mover")[1] == 0.05


def test_the_belt_carries_at_its_speed():
    items = (Item("pencil", yaw_rad=1.0), Item("beside", x_m=0.2))
    cell = Cell(CellDesign(items=items, belt=Belt(speed_m_s=0.08, width_m=0.24)))
    cell.advance(0.5)
    start = cell.station_from("pencil").translation[1]
    cell.advance(1.0)
    assert cell.station_from("pencil").translation[1] - start == pytest.approx(0.08, abs=2e-4)
    assert abs(cell.station_from("beside").translation[1]) < 1e-4


@pytest.mark.parametrize(
    ("shape", "yaw_deg", "along_m"),
    [("rod", 0, 0.0), ("rod", 35, 0.02), ("pencil", 70, -0.015), ("hexagon", 110, 0.0), ("pencil", 165, 0.0)],
)
def test_a_rod_is_grasped_lifted_and_held(shape, yaw_deg, along_m):
    """Lifted by 4 cm and held 1 s: it stays up, and does not creep in the fingers by more than 0.1 mm."""
    yaw = np.radians(yaw_deg)
    design = CellDesign(
        items=(Item("it", shape, x_m=0.02, y_m=-0.03, yaw_rad=yaw),), arm=ArmMount(), base_from_station=SKEWED
    )
    cell = Cell(design)
    grip = cell.station_from("it").apply(np.array([[along_m, 0, 0]]))[0]
    across = (0.7 + yaw) % np.pi - np.pi / 2  # of the rod, in {B}; half a turn more would do as well

    def reach(height: float) -> np.ndarray:
        x, y, z = SKEWED.apply(np.array([[grip[0], grip[1], height]]))[0]
        return tool_down(x, y, z, across)

    cell.pose_arm(reach(0.05), opening_m=0.03)
    cell.follow(np.array([0, 0.6]), np.array([reach(0.05), reach(0.0045)]))
    cell.advance(0.3)
    assert np.abs(cell.station_from_tool.translation - [grip[0], grip[1], 0.0045]).max() < 2e-4
    cell.advance(0.5, opening_m=cell.opening_limits_m[0])
    assert 0.006 < cell.opening_m < 0.0105
    lying = cell.station_from("it").translation[2]
    cell.follow(np.array([0, 0.6]), np.array([reach(0.0045), reach(0.0445)]))
    cell.advance(0.2)
    in_hand = cell.station_from_tool.inverse() @ cell.station_from("it")
    cell.advance(1.0)
    crept = (cell.station_from_tool.inverse() @ cell.station_from("it")) @ in_hand.inverse()
    assert cell.station_from("it").translation[2] - lying > 0.0395
    assert np.linalg.norm(crept.translation) < 1e-4
    assert np.linalg.norm(crept.rotvec()) < np.radians(0.3)
    cell.advance(0.5, opening_m=0.03)
    assert cell.station_from("it").translation[2] == pytest.approx(lying, abs=1e-3)


def test_nothing_is_held_that_friction_cannot_hold():
    """No welding: fingers that close beside a rod lift nothing."""
    cell = Cell(CellDesign(items=(Item("it", "rod", x_m=0.03),), arm=ArmMount()))
    x, y, z = cell.base_from_station.apply(np.array([[0.03, 0.02, 0.0045]]))[0]
    low, high = tool_down(x, y, z, np.pi / 2), tool_down(x, y, z + 0.04, np.pi / 2)
    cell.pose_arm(low, opening_m=0.02)
    cell.advance(0.5, opening_m=0.0)
    cell.follow(np.array([0, 0.5]), np.array([low, high]))
    assert cell.station_from_tool.translation[2] > 0.04
    assert cell.station_from("it").translation[2] < 0.005


def test_servos_hold_without_sag_and_follow():
    cell = Cell(CellDesign(arm=ArmMount()))
    target = tool_down(0.4, 0.1, 0.2, 0.4)
    cell.pose_arm(cell.joints)
    cell.advance(1.0, joints=target)
    assert np.abs(cell.joints - target).max() < 1e-3
    assert np.abs(cell.base_from_tool.translation - [0.4, 0.1, 0.2]).max() < 2e-4
    assert np.abs(cell.joint_rates).max() < 1e-2
    assert cell.joint_names == ("d1", "theta2", "theta3", "theta4", "theta5")
    assert cell.joint_limits[0] == pytest.approx((0, 0.4))


def test_who_watches_is_called_in_time_and_changes_nothing():
    watched, alone = (Cell(CellDesign(items=(Item("rod", "rod", (0.12, 0.01), above_m=0.02),))) for _ in "ab")
    times: list[float] = []
    watched.watch(0.04, lambda: times.append(watched.time_s))
    watched.advance(0.1)
    watched.advance(0.1)
    watched.watch(0.04, None)
    watched.advance(0.1)
    alone.advance(0.1)
    alone.advance(0.1)
    alone.advance(0.1)
    assert np.allclose(times, [0.04, 0.08, 0.12, 0.16, 0.2], atol=1e-9)
    assert (watched.data.qpos == alone.data.qpos).all()
    with pytest.raises(BadParameter, match="positive"):
        watched.watch(0.0, lambda: None)


def test_the_label_moves_as_its_velocity_says():
    """Posed with joint rates, the label's velocity is the difference of its poses."""
    cell = Cell(CellDesign(arm=ArmMount(), base_from_station=SKEWED))
    q, rates, h = tool_down(0.4, 0.1, 0.2, 0.4), np.array([0.05, 0.4, -0.6, 0.0, 1.0]), 1e-6
    poses = []
    for step in (-h, h):
        cell.pose_arm(q + step * rates)
        poses.append(cell.station_from("label"))
    cell.pose_arm(q, rates=rates)
    v = cell.velocity("label")
    assert np.allclose(v[:3], (poses[1].translation - poses[0].translation) / (2 * h), atol=1e-6)
    turned = SE3(poses[1].rotation @ poses[0].rotation.T, np.zeros(3)).rotvec()
    assert np.allclose(v[3:], turned / (2 * h), atol=1e-6)
    assert cell.tracked == ("label",)


def test_paths_are_exact_at_any_time():
    path = Circle((0.02, 0.05), 0.08, 1.3, yaw_rad=0.2)
    cell = Cell(CellDesign(items=(Item("a", path=path),), base_from_station=SKEWED))
    for time_s in (3.0, 0.4, 1.7):
        cell.at(time_s)
        x, y, _, yaw = path.at(time_s)
        pose = cell.station_from("a")
        assert np.allclose(pose.translation, (x, y, 0.004), atol=1e-12)
        assert np.allclose(pose.rotation[:2, 0], (np.cos(yaw), np.sin(yaw)), atol=1e-12)
        assert np.allclose(cell.velocity("a")[[0, 1, 2, 5]], path.rate(time_s))
    cell.reset()
    cell.advance(1 / 30)
    assert cell.time_s == pytest.approx(1 / 30, abs=1e-12)  # whole steps end exactly there


def test_the_same_seed_gives_the_same_run():
    design = CellDesign(items=tuple(Item(f"p{i}") for i in range(5)), arm=ArmMount())

    def run(seed: int | None) -> np.ndarray:
        cell = Cell(design)
        cell.advance(0.1)
        cell.reset(seed)
        cell.advance(0.2)
        return cell.data.qpos.copy()

    assert (run(3) == run(3)).all()
    assert (run(3) != run(4)).any()
    assert (run(None) != run(4)).any()


FOREIGN = """
<mujoco>
  <worldbody>
    <geom name="foot" type="box" size="0.1 0.1 0.02"/>
    <body name="link" pos="0 0 0.3">
      <joint name="swing" type="hinge" axis="0 0 1"/>
      <geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0"/>
      <body pos="0.3 0 0"><joint name="lift" type="slide" axis="0 0 1" range="-0.2 0.2" limited="true"/>
        <geom type="sphere" size="0.03"/><site name="tool" pos="0 0 -0.1"/></body>
    </body>
  </worldbody>
</mujoco>
"""


def test_an_arm_from_another_file(tmp_path):
    """Any MJCF with a site "tool" does: its chain is found, its geoms are sorted, what it lacks is said."""
    path = tmp_path / "other.xml"
    path.write_text(FOREIGN)
    cell = Cell(CellDesign(arm=ArmMount(mjcf=path, label=None)))
    assert cell.joint_names == ("swing", "lift")
    assert cell.joint_limits.tolist() == [[-np.inf, np.inf], [-0.2, 0.2]]
    cell.pose_arm(np.array([np.pi / 2, 0.1]))
    assert np.allclose(cell.base_from_tool.translation, (0, 0.3, 0.3), atol=1e-9)
    assert np.isnan(cell.opening_m)
    assert cell.tracked == ()
    groups = {cell.model.geom(i).name: int(cell.model.geom_group[i]) for i in range(cell.model.ngeom)}
    assert groups["arm/foot"] == FIXED
    assert groups["table"] == groups["floor"] == BACKGROUND
    assert (cell.model.geom_group == MOVING).sum() == 2
    with pytest.raises(BadParameter, match="position actuator"):
        cell.advance(0.1, joints=np.zeros(2))
    with pytest.raises(BadParameter, match="no gripper"):
        cell.advance(0.1, opening_m=0.01)
    with pytest.raises(BadParameter, match='site "label"'):
        Cell(CellDesign(arm=ArmMount(mjcf=path)))
    path.write_text("<mujoco><worldbody/></mujoco>")
    with pytest.raises(BadParameter, match='site "tool"'):
        Cell(CellDesign(arm=ArmMount(mjcf=path)))
    path.write_text("<mujoco")
    with pytest.raises(BadParameter, match="MuJoCo can read"):
        Cell(CellDesign(arm=ArmMount(mjcf=path)))


def test_groups_tell_what_moves():
    items = (Item("free"), Item("still", fixed=True, y_m=0.1), Item("led", path=Straight((0, -0.1, 0, 0))))
    model = Cell(CellDesign(items=items, arm=ArmMount())).model
    group = {model.geom(i).name: int(model.geom_group[i]) for i in range(model.ngeom)}
    assert group["item/free/1"] == group["item/led/0"] == group["arm/forearm"] == group["arm/label"] == MOVING
    assert group["item/still/0"] == group["arm/column"] == FIXED
    assert group["item/free/solid"] == COLLIDERS


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Item("a", "box", (0.1, 0.1)), "x, y, z"),
        (lambda: Item("a", colour=(2, 0, 0)), "from 0 to 1"),
        (lambda: Item("a", fixed=True, path=Straight((0, 0, 0, 0))), "one of the two"),
        (lambda: CellDesign(items=(Item("a"), Item("a"))), "different"),
        (lambda: Table(surface="marble"), "plain, wood"),
        (lambda: Cell(CellDesign(belt=Belt(x_m=0.6))), "inside the table"),
        (lambda: Cell(CellDesign()).joints, "ArmMount"),
        (lambda: Cell(CellDesign(items=(Item("a"),))).station_from("b"), "one of a"),
        (lambda: Cell(CellDesign(arm=ArmMount())).advance(0.1, joints=np.zeros(4)), "5 numbers"),
        (lambda: Cell(CellDesign(arm=ArmMount())).follow(np.array([1, 0.5]), np.zeros((2, 5))), "rising"),
        (lambda: Cell(CellDesign()).advance(-1), "zero or more"),
        (lambda: Cell(CellDesign(items=(Item("a", fixed=True),))).place("a", SE3.identity()), "a free one"),
    ],
)
def test_what_cannot_be_is_refused(make, words):
    with pytest.raises(BadParameter, match=words):
        make()
