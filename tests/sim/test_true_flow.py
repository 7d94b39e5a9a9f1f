"""True flow is the motion of the points seen: against cast rays, warped pictures, itself backwards."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, pixel_grid
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import (
    ArmMount,
    Belt,
    CellDesign,
    Item,
    Lights,
    StationCamera,
    Table,
    look_at,
)
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.paths import Circle, Straight
from vision_robot.sim.surfaces import BELT_PITCH_M
from vision_robot.sim.true_flow import true_flow
from vision_robot.sim.truth import TruthFrame, TruthRenderer

CAMERAS = {
    "pinhole": Camera(240, 180, 260, 255, 121.3, 88.1),
    "brown5": Camera(240, 180, 260, 255, 121.3, 88.1, 0.7, "brown5", (-0.2, 0.05, 0.001, -0.001, 0.0)),
    "fisheye": Camera(240, 180, 110, 108, 121.3, 88.1, 0.0, "fisheye", (0.01, 0.0, 0.0, 0.0)),
}
ITEMS = (
    Item("disc", "disc", (0.08, 0.01), path=Straight((-0.05, -0.1, 0, 0), (0.1, 0.15, 0, 0))),
    Item("pencil", path=Straight((0.05, 0.05, 0, 0), (0.05, 0.02, 0, 1.0))),
    Item("box", "box", (0.05, 0.04, 0.04), path=Circle((0.0, 0.05), 0.06, 1.5)),
    Item("still", "box", (0.04, 0.04, 0.02), x_m=-0.08, y_m=-0.1, fixed=True),
)
PLAIN = Lights(shadows=False)
SHAKE = SE3.from_rotvec(np.array([0.003, -0.004, 0.01]), np.array([0.002, 0.001, -0.003]))


def view_of(name: str) -> StationCamera:
    return look_at(CAMERAS[name], (-0.06, 0.05, 0.28 if name == "fisheye" else 0.45))


def pair(name: str, *, shake: SE3 | None = None) -> tuple[Cell, TruthFrame, TruthFrame]:
    """Two frames 0.15 s apart; the cell is left at the second."""
    cell, view = Cell(CellDesign(items=ITEMS, lights=PLAIN)), view_of(name)
    with TruthRenderer(cell, view, depth=True) as eye:
        cell.at(0.3)
        before = eye.frame()
        cell.at(0.45)
        after = eye.frame(None if shake is None else shake @ view.cam_from_station)
    return cell, before, after


def cast(
    cell: Cell, before: TruthFrame, after: TruthFrame, pixels: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """True flow at (u, v) pixels by rays through the exact geometry; body and geom that each meets."""
    mj, shown = load_mujoco(), np.array([1, 1, 1, 0, 0, 0], dtype=np.uint8)
    cell.at(before.time_s)
    base_from_cam = cell.base_from_station @ before.cam_from_station.inverse()
    rays = before.camera.unproject(pixels.astype(float)) @ base_from_cam.rotation.T
    points, bodies = [], []
    for ray in rays:
        geom = np.zeros(1, dtype=np.int32)
        reach = mj.mj_ray(cell.model, cell.data, base_from_cam.translation, ray, shown, 1, -1, geom, None)
        assert reach > 0
        body = int(cell.model.geom_bodyid[geom[0]])
        R, t = cell.data.xmat[body].reshape(3, 3), cell.data.xpos[body]
        points.append(R.T @ (base_from_cam.translation + reach * ray - t))
        bodies.append(body)
    cell.at(after.time_s)
    R, t = cell.data.xmat[bodies].reshape(-1, 3, 3), cell.data.xpos[bodies]
    moved = (R @ np.array(points)[..., None])[..., 0] + t
    in_cam = (after.cam_from_station @ cell.base_from_station.inverse()).apply(moved)
    return after.camera.project(in_cam) - pixels, np.array(bodies), in_cam


@pytest.mark.parametrize("shake", [None, SHAKE], ids=["still", "shaken"])
@pytest.mark.parametrize("name", CAMERAS)
def test_flow_is_the_motion_of_points_met_by_rays(name, shake):
    """Mean endpoint error <= 0.02 px with any lens, <= 0.0005 px at every pixel of a pinhole."""
    cell, before, after = pair(name, shake=shake)
    flow = true_flow(before, after)
    rng = np.random.default_rng(1)
    wanted = before.ids > 0
    if shake is not None:
        wanted |= rng.random(wanted.shape) < 0.05
    assert before.depth is not None
    wanted &= np.isfinite(flow.flow_px[..., 0]) & np.isfinite(before.depth)
    v, u = np.nonzero(wanted)
    some = rng.permutation(len(u))[:800]
    u, v = u[some], v[some]
    exact, bodies, _ = cast(cell, before, after, np.stack([u, v], axis=1))
    same = bodies + 1 == before.bodies[v, u]  # a ray that grazes an outline may meet the other side
    assert same.mean() > (0.995 if name == "pinhole" else 0.96)
    error = np.linalg.norm(flow.flow_px[v, u] - exact, axis=1)[same]
    assert np.linalg.norm(exact, axis=1).max() > 8
    assert error.mean() < 0.02
    if name == "pinhole":
        assert error.max() < 5e-4


def test_small_steps_are_the_derivative_of_the_projection():
    """Over 1 ms, flow / dt at a thing's middle is the finite difference of its projected middle."""
    cell, view = (
        Cell(CellDesign(items=(Item("a", path=Circle((0, 0.05), 0.06, 1.5)),), lights=PLAIN)),
        view_of("pinhole"),
    )
    with TruthRenderer(cell, view, depth=True) as eye:
        frames = []
        for time_s in (0.2995, 0.3, 0.301):
            cell.at(time_s)
            frames.append(eye.frame())
    top = cell.station_from("a").apply(np.array([[0, 0, 0.004]]))  # the flat on which the camera looks down
    u, v = np.rint(view.camera.project(view.cam_from_station.apply(top)))[0].astype(int)
    rate = true_flow(frames[1], frames[2]).flow_px[v, u] / 0.001
    slope = (frames[2].objects.centre_px[0] - frames[1].objects.centre_px[0]) / 0.001
    assert np.linalg.norm(slope) > 20
    assert np.abs(rate - slope).max() < 0.03 * np.linalg.norm(slope)  # the top is 4 mm nearer, and turns


@pytest.mark.parametrize("name", CAMERAS)
def test_the_second_picture_warped_back_is_the_first(name):
    """Photometric error on points seen in both: a few grey levels; without warping ten times that."""
    cell = Cell(CellDesign(items=ITEMS, lights=PLAIN, table=Table(surface="speckled")))
    view = view_of(name)
    with TruthRenderer(cell, view, depth=True) as eye:
        cell.at(0.3)
        before = eye.frame()
        cell.at(0.45)
        after = eye.frame(SHAKE @ view.cam_from_station)
    flow = true_flow(before, after)
    there = (pixel_grid(240, 180) + np.nan_to_num(flow.flow_px)).astype(np.float32)
    warped = cv2.remap(after.image, there[..., 0], there[..., 1], cv2.INTER_LINEAR)
    both = cv2.erode((~flow.occluded).astype(np.uint8), np.ones((5, 5))) > 0
    both &= cv2.morphologyEx(before.bodies.astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((5, 5))) == 0
    both &= before.ids > 0
    assert both.sum() > 600
    error = np.abs(warped.astype(float) - before.image)[both].mean()
    unwarped = np.abs(after.image.astype(float) - before.image)[both].mean()
    assert error < 4
    assert unwarped > 5 * error


@pytest.mark.parametrize("name", CAMERAS)
def test_there_and_back_again(name):
    """Where a point is seen in both frames, the flow backwards from where it went is the flow reversed."""
    _, before, after = pair(name, shake=SHAKE)
    ahead, back = true_flow(before, after), true_flow(after, before)
    there = (pixel_grid(240, 180) + np.nan_to_num(ahead.flow_px)).astype(np.float32)
    returned = cv2.remap(back.flow_px, there[..., 0], there[..., 1], cv2.INTER_LINEAR)
    flat = cv2.morphologyEx(before.bodies.astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((7, 7))) == 0
    inside = ((there > 2) & (there < np.array([237, 177]))).all(axis=-1)
    sure = ~ahead.occluded & flat & inside & np.isfinite(returned[..., 0])
    difference = np.linalg.norm(ahead.flow_px + returned, axis=-1)[sure]
    assert len(difference) > 10000
    assert np.quantile(difference, 0.99) < 0.1


def test_what_is_covered_is_occluded():
    """A box that slides over the table hides what lies ahead of it, and nothing behind it."""
    slide = Item("box", "box", (0.04, 0.04, 0.01), path=Straight((0, -0.04, 0, 0), (0, 0.1, 0, 0)))
    cell, view = Cell(CellDesign(items=(slide,), lights=PLAIN)), look_at(CAMERAS["pinhole"], (0, 0, 0.5))
    with TruthRenderer(cell, view, depth=True) as eye:
        cell.at(0.0)
        before = eye.frame()
        cell.at(0.4)
        after = eye.frame()
        aside = eye.frame(SE3(np.eye(3), np.array([0.5, 0, 0])) @ view.cam_from_station)
    flow = true_flow(before, after)
    background = before.ids == 0
    covered = background & (after.ids == 1)
    assert flow.occluded[covered].mean() > 0.97
    assert flow.occluded[background & ~covered].mean() < 1e-3
    assert flow.occluded[before.ids == 1].mean() < 0.1  # its side wall turns away, its top stays in sight
    assert (flow.flow_px[background] == 0).all()
    assert true_flow(after, aside).occluded.mean() > 0.9  # nearly all has left the picture


def test_the_arm_flows_too():
    cell = Cell(CellDesign(arm=ArmMount(start=(0.1, 0.3, -0.6, 0, 0)), lights=PLAIN))
    with TruthRenderer(cell, look_at(CAMERAS["pinhole"], (0, 0, 0.75)), depth=True) as eye:
        before = eye.frame()
        cell.pose_arm(np.array([0.1, 0.35, -0.6, 0, 0]))
        cell.data.time = 0.1
        after = eye.frame()
    flow = true_flow(before, after)
    moved = np.linalg.norm(flow.flow_px, axis=-1) > 1
    assert 0.02 < moved.mean() < 0.4
    assert (flow.flow_px[before.bodies == cell.model.body("station").id + 1] == 0).all()


def test_frames_that_make_no_flow_are_refused():
    cell, view = Cell(CellDesign(items=ITEMS[:1], lights=PLAIN)), view_of("pinhole")
    with TruthRenderer(cell, view) as eye:
        flat = eye.frame()
    with TruthRenderer(cell, view, depth=True) as eye:
        deep = eye.frame()
    with pytest.raises(BadParameter, match="depth=True"):
        true_flow(deep, flat)
    with pytest.raises(BadParameter, match="the same"):
        true_flow(deep, replace(deep, camera=CAMERAS["fisheye"]))
    assert not true_flow(deep, deep).flow_px.any()
    assert not true_flow(deep, deep).occluded.any()


def test_a_belt_flows_on_when_its_picture_jumps_back():
    """The belt that is seen jumps back by a pitch each second here; its flow is that of the rubber."""
    belt = Belt(speed_m_s=BELT_PITCH_M, width_m=0.2)
    cell, view = Cell(CellDesign(lights=PLAIN, belt=belt)), view_of("pinhole")
    with TruthRenderer(cell, view, depth=True) as eye:
        frames = []
        for time_s in (0.85, 0.95, 1.05):
            cell.at(time_s)
            frames.append(eye.frame())
    smooth, jumping = (true_flow(*frames[k : k + 2]) for k in (0, 1))
    middle = np.s_[80:100, 110:130]
    assert np.hypot(*smooth.flow_px[middle].reshape(-1, 2).T).min() > 3
    assert np.allclose(jumping.flow_px[middle], smooth.flow_px[middle], atol=1e-3)
    assert not jumping.occluded[middle].any()
