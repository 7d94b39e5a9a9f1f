"""Moments of a miss: they add up, and what is foretold is what linear errors give."""

from dataclasses import replace

import numpy as np
import pytest

from vision_robot.evaluate.attribution import subsets
from vision_robot.geometry import SE3, WorkPlane
from vision_robot.pick.calibrated import rigid_fit, rigid_fit_covariance
from vision_robot.pick.goal import station_from_grasp
from vision_robot.pick.knowledge import STAGES, Knowledge
from vision_robot.pick.moments import Moments
from vision_robot.pick.prediction import predicted
from vision_robot.pick.rehearsal import Rehearsal
from vision_robot.pick.sighting import Seen, sighting
from vision_robot.pick.world import ordinary_world

RNG = np.random.default_rng(1)
WORLD = ordinary_world(shadows=False)
HEIGHT = 0.005
JOINTS = np.array([0.2, 0.4, -0.9, 0.0, 0.3])
NOTHING = Rehearsal(np.zeros((3, 3)), np.zeros((5, 5)), 1)


def seen_at(x, y, yaw):
    along = 0.03 * np.array([np.cos(yaw), np.sin(yaw), 0.0])
    middle = np.array([x, y, HEIGHT])
    pose, camera = WORLD.view.cam_from_station, WORLD.view.camera
    pixels = camera.project(pose.apply(np.stack([middle, middle + along, middle - along])))
    ahead = pixels[1] - pixels[2]
    return Seen(pixels[0], float(np.arctan2(ahead[1], ahead[0])), 2 * float(np.linalg.norm(ahead)))


def test_inclusion_and_exclusion_give_back_the_products():
    """Of misses that are sums of parts, with any products between them; the rest is nothing then."""
    parts = RNG.normal(size=(5, 400, 3)) * 1e-3
    parts[2] -= 0.8 * parts[0]  # two that cancel
    misses = {
        true: sum((parts[i] for i, one in enumerate(STAGES) if one not in true), np.zeros((400, 3)))
        for true in subsets(STAGES)
    }
    found = Moments.measured(STAGES, misses)
    wanted = np.einsum("isk,jsk->ij", parts[:, :, :2], parts[:, :, :2]) / 400
    assert np.allclose(found.position_m2, wanted, atol=1e-15)
    assert found.position_m2[0, 2] < 0
    assert abs(found.rest_m2) < 1e-15
    for true in subsets(STAGES):
        rms = np.sqrt((misses[true][:, :2] ** 2).sum(axis=1).mean())
        assert found.rms_m(true) == pytest.approx(rms)
        assert found.yaw_rms_rad(true) == pytest.approx(np.sqrt((misses[true][:, 2] ** 2).mean()))
    everything = found.position_m2.sum() + found.floor_m2 + found.rest_m2
    assert everything == pytest.approx((misses[frozenset()][:, :2] ** 2).sum(axis=1).mean())


def test_nothing_uncertain_foretells_no_error():
    found = predicted(WORLD.truth, seen_at(0.02, -0.03, 0.5), HEIGHT, JOINTS, NOTHING)
    assert found.rms_m() == 0
    assert found.yaw_rms_rad() == 0


def test_noise_in_the_picture_is_foretold_as_it_spreads():
    seen = seen_at(0.02, -0.03, 0.5)
    sigma = np.array([0.4, 0.2, 0.01])
    found = predicted(WORLD.truth, seen, HEIGHT, JOINTS, Rehearsal(np.diag(sigma**2), np.zeros((5, 5)), 1))
    places, turns = [], []
    for u, v, yaw in RNG.normal(size=(2000, 3)) * sigma:
        said = replace(seen, centroid_px=seen.centroid_px + np.array([u, v]), yaw_rad=seen.yaw_rad + yaw)
        where = sighting(WORLD.truth.plane, said, HEIGHT)
        places.append(where.position_m - [0.02, -0.03])
        turns.append(where.yaw_rad - 0.5)
    assert found.rms_m() == pytest.approx(np.sqrt((np.array(places) ** 2).sum(axis=1).mean()), rel=0.05)
    assert found.yaw_rms_rad() == pytest.approx(np.std(turns), rel=0.05)
    assert found.alone_m("tracking") == found.rms_m()
    assert found.rms_m({"tracking"}) == 0


def test_errors_of_camera_and_plane_cancel_as_their_cross_terms_say():
    """A camera that is wrong, and a plane found with it that is wrong the other way."""
    size = len(WORLD.view.camera.parameters)
    shift = np.zeros(size + 6)
    shift[0], shift[1] = 3.0, 3.0  # focal lengths [px] ...
    shift[-1] = 3.0 * 0.75 / 700  # ... and the distance they are taken for [m]
    plane = WorkPlane(WORLD.view.camera, WORLD.view.cam_from_station, np.outer(shift, shift))
    known = Knowledge(plane, WORLD.design.base_from_station, WORLD.arm)
    found = predicted(known, seen_at(0.05, 0.08, 0.0), HEIGHT, JOINTS, NOTHING)
    assert found.rms_m() < 0.2 * found.alone_m("calibration")
    assert found.rms_m({"plane"}) == pytest.approx(found.alone_m("calibration"))


def test_servos_and_the_arms_geometry_are_told_apart():
    servo = np.diag([0.0, 1e-3, 0.0, 0.0, 0.0]) ** 2
    known = replace(WORLD.truth, joint_covariance=4 * servo)
    found = predicted(known, seen_at(0.0, 0.0, 0.0), HEIGHT, JOINTS, Rehearsal(np.zeros((3, 3)), servo, 1))
    chain, turned = WORLD.arm.chain, JOINTS + np.array([0, 1e-3, 0, 0, 0])
    moved = chain.base_from_tool(turned).translation - chain.base_from_tool(JOINTS).translation
    assert found.alone_m("control") == pytest.approx(np.linalg.norm(moved), rel=1e-3)
    assert found.alone_m("ik") == pytest.approx(2 * found.alone_m("control"), rel=1e-3)
    assert found.alone_m("plane") == 0


def test_the_covariance_of_touched_marks_is_honest():
    """Squared errors in units of it are 6 on average (chi-square), with its own scale from few residuals."""
    points = np.array([[-0.1, -0.12, 0], [-0.1, 0.12, 0], [0.1, 0.12, 0], [0.1, -0.12, 0]])
    pose = SE3.exp(np.array([0.3, 0.1, 0.05, 0.02, -0.03, 0.4]))
    offs, told = [], []
    for _ in range(400):
        moved = pose.apply(points) + RNG.normal(0, 2e-4, points.shape)
        fitted = rigid_fit(points, moved)
        turn = SE3(fitted.rotation @ pose.rotation.T, np.zeros(3)).rotvec()
        offs.append([*turn, *(fitted.translation - pose.translation)])
        told.append(np.diag(rigid_fit_covariance(points, moved, fitted)))
    ratio = (np.array(offs) ** 2).mean(axis=0) / np.mean(told, axis=0)
    assert (np.abs(ratio - 1) < 0.25).all()


def test_a_goal_is_asked_for_where_it_was_seen():
    where = sighting(WORLD.truth.plane, seen_at(0.03, 0.01, 0.2), HEIGHT)
    goal = station_from_grasp(where.position_m, where.yaw_rad, HEIGHT)
    assert np.allclose(goal.translation, [0.03, 0.01, HEIGHT], atol=1e-6)
