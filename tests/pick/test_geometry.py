"""From pixel to joints: the laws that each step of the chain obeys."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.arm import read_arm
from vision_robot.arm.ik import InverseKinematics
from vision_robot.errors import BadParameter, Unreachable
from vision_robot.geometry import SE3, Camera, WorkPlane
from vision_robot.pick.calibrated import rigid_fit
from vision_robot.pick.episode import miss_of
from vision_robot.pick.goal import joints_for, station_from_grasp, upright
from vision_robot.pick.knowledge import STAGES, Knowledge
from vision_robot.pick.sighting import Seen, sighting
from vision_robot.pick.world import ordinary_world
from vision_robot.sim.outline import area_moments, outline_of
from vision_robot.sim.shapes import shape_named

RNG = np.random.default_rng(0)
ANGLE = st.floats(-np.pi, np.pi)
CAMERA = Camera(640, 480, 700, 705, 320, 236, 0.0, "brown5", (-0.1, 0.03, 1e-3, 0, 0))
LOOKING_DOWN = ordinary_world().view.cam_from_station
PLANE = WorkPlane.exact(CAMERA, LOOKING_DOWN)


@given(ANGLE, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_a_thing_is_seen_where_it_lies(yaw, x, y):
    along = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    middle = np.array([x, y, 0.005])
    pixels = CAMERA.project(
        LOOKING_DOWN.apply(np.stack([middle, middle + 0.03 * along, middle - 0.03 * along]))
    )
    ahead = pixels[1] - pixels[2]
    seen = Seen(pixels[0], float(np.arctan2(ahead[1], ahead[0])), 2 * float(np.linalg.norm(ahead)))
    found = sighting(PLANE, seen, 0.005)
    assert np.allclose(found.position_m, [x, y], atol=1e-9)
    assert (
        abs((found.yaw_rad - yaw + np.pi / 2) % np.pi - np.pi / 2) < 2e-3
    )  # the lens bends the line a little


@given(ANGLE)
def test_fingers_close_across_the_axis(yaw):
    goal = station_from_grasp(np.array([0.1, 0.2]), yaw, 0.03)
    along = np.array([np.cos(yaw), np.sin(yaw), 0])
    assert np.linalg.det(goal.rotation) == pytest.approx(1)
    assert goal.rotation[:, 0] @ along == pytest.approx(0, abs=1e-12)
    assert goal.rotation[:, 2].tolist() == [0, 0, -1]


def test_upright_is_the_least_turn():
    tilted = SE3.exp(np.array([0.1, 0.2, 0.3, np.pi - 0.05, 0.03, 0.0]))
    made = upright(tilted)
    assert np.allclose(made.rotation[:, 2], [0, 0, -1])
    turn = np.linalg.norm((tilted.inverse() @ made).rotvec())
    assert turn == pytest.approx(np.arccos(-tilted.rotation[2, 2]), abs=1e-9)


def test_joints_bring_the_tool_there_and_far_goals_are_refused():
    arm = read_arm("column")
    solver, station = InverseKinematics(arm), SE3(np.eye(3), np.array([0.36, 0, 0.07]))
    goal = station_from_grasp(np.array([0.03, -0.05]), 0.7, 0.02)
    near = np.mean(arm.chain.limits, axis=1)
    q = joints_for(solver, station, goal, near)
    off = arm.chain.base_from_tool(q).inverse() @ station @ goal
    assert np.linalg.norm(off.translation) < 1e-6
    assert abs(off.rotation[2, 2] - 1) < 1e-9
    faced = joints_for(solver, station, goal, near, back_towards_m=np.array([5.0, 0.0]))
    assert arm.chain.base_from_tool(faced).rotation[0, 1] < 0  # its back, -y, looks towards +x
    with pytest.raises(Unreachable, match="mm are missing"):
        joints_for(solver, station, station_from_grasp(np.array([2.0, 0]), 0, 0.02), near)


def test_rigid_fit_undoes_a_motion():
    points, pose = RNG.normal(size=(5, 3)), SE3.exp(RNG.normal(size=6))
    found = rigid_fit(points, pose.apply(points))
    assert np.allclose(found.as_matrix(), pose.as_matrix())


def test_a_miss_is_across_along_and_headless():
    thing = SE3.from_rotvec(np.array([0, 0, np.pi / 2]), np.array([0.1, 0.2, 0.005]))
    miss = miss_of(thing, np.array([0.101, 0.203, 0.006]), -np.pi / 2 + 0.01)
    assert miss.across_m == pytest.approx(-0.001)
    assert miss.along_m == pytest.approx(0.003)
    assert miss.height_m == pytest.approx(0.001)
    assert miss.yaw_rad == pytest.approx(0.01)


def test_stages_are_replaced_by_the_truth():
    world = ordinary_world()
    wrong = SE3.exp(np.full(6, 0.01))
    believed = Knowledge(
        WorkPlane.exact(CAMERA, wrong @ LOOKING_DOWN), wrong @ world.design.base_from_station, world.arm
    )
    truth = world.truth
    mended = believed.corrected(truth, {"plane"})
    assert np.allclose(mended.plane.cam_from_station.translation, LOOKING_DOWN.translation)
    assert np.allclose(mended.base_from_station.translation, world.design.base_from_station.translation)
    assert mended.plane.camera == CAMERA
    assert believed.corrected(truth, {"calibration"}).plane.camera == world.view.camera
    assert believed.corrected(truth, {"tracking", "control"}) is not None
    with pytest.raises(BadParameter, match="luck"):
        believed.corrected(truth, {"luck"})
    assert set(STAGES) >= {"calibration", "ik"}


@given(ANGLE, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.sampled_from(["rod", "box", "disc"]))
def test_a_body_is_found_by_its_outline_where_it_lies(yaw, x, y, shape):
    """Near ends look larger, sides are seen besides tops: the hull tells by how much."""
    size = {"rod": (0.12, 0.01), "box": (0.05, 0.03, 0.02), "disc": (0.04, 0.01)}[shape]
    body = shape_named(shape, size, (0.8, 0.1, 0.1))
    pose = SE3.from_rotvec(np.array([0, 0, yaw]), np.array([x, y, body.rest_m]))
    polygon = outline_of((LOOKING_DOWN @ pose).apply(body.hull), CAMERA)
    assert polygon is not None
    moments = area_moments(polygon)
    (major, minor), direction = moments.axes()
    seen = Seen(moments.centroid, direction, float(major), float(minor), body.hull)
    found = sighting(PLANE, seen, body.rest_m)
    assert np.allclose(found.position_m, [x, y], atol=2e-5)
    if shape != "disc":
        assert abs((found.yaw_rad - yaw + np.pi / 2) % np.pi - np.pi / 2) < 1e-3


def test_a_rod_that_points_at_the_camera_is_not_where_its_centroid_is():
    body = shape_named("rod", (0.12, 0.01), (0.8, 0.1, 0.1))
    pose = SE3.from_rotvec(np.zeros(3), np.array([0.08, 0.0, body.rest_m]))
    polygon = outline_of((LOOKING_DOWN @ pose).apply(body.hull), CAMERA)
    assert polygon is not None
    moments = area_moments(polygon)
    seen = Seen(moments.centroid, moments.axes()[1], 100.0, 8.0, body.hull)
    assert abs(sighting(PLANE, seen, 0.005).position_m[0] - 0.08) < 2e-5
    assert abs(sighting(PLANE, replace(seen, hull=None), 0.005).position_m[0] - 0.08) > 5e-4
