"""The truth about a picture is true: judged by counting pixels of far finer pictures, and by closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from vision_robot.geometry import SE3, Camera
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import ArmMount, CellDesign, Item, Lights, StationCamera, look_at
from vision_robot.sim.paths import Straight
from vision_robot.sim.truth import TruthFrame, TruthRenderer

PINHOLE = Camera(240, 180, 260, 255, 121.3, 88.1)
CAMERAS = {
    "pinhole": PINHOLE,
    "brown5": Camera(240, 180, 260, 255, 121.3, 88.1, 0.7, "brown5", (-0.2, 0.05, 0.001, -0.001, 0.0)),
    "fisheye": Camera(240, 180, 110, 108, 121.3, 88.1, 0.0, "fisheye", (0.01, 0.0, 0.0, 0.0)),
}
FINER = 5
ITEMS = (
    Item("disc", "disc", (0.06, 0.01), x_m=0.08, y_m=0.11, fixed=True),
    Item("under", "rod", (0.14, 0.01), x_m=-0.03, y_m=0.02, yaw_rad=0.4, fixed=True),
    Item("over", "box", (0.05, 0.03, 0.02), x_m=-0.01, y_m=0.03, above_m=0.03, yaw_rad=1.0, fixed=True),
    Item("pencil", "pencil", (0.15, 0.009), x_m=0.05, y_m=-0.1, yaw_rad=2.0, fixed=True),
    Item("cut", "box", (0.05, 0.05, 0.02), x_m=-0.02, y_m=-0.2, yaw_rad=0.3, fixed=True),
)
DARK = Lights(shadows=False)


def view_of(camera: Camera) -> StationCamera:
    height = 0.45 if camera.model != "fisheye" else 0.28
    return look_at(camera, (-0.06, 0.05, height), (0.0, 0.0, 0.0))


def finer(camera: Camera) -> Camera:
    """The same camera with FINER x FINER pixels for each."""
    n = FINER
    return replace(
        camera,
        width=n * camera.width,
        height=n * camera.height,
        fx=n * camera.fx,
        fy=n * camera.fy,
        cx=n * (camera.cx + 0.5) - 0.5,
        cy=n * (camera.cy + 0.5) - 0.5,
        skew=n * camera.skew,
    )


def seen(items: tuple[Item, ...], camera: Camera, view: StationCamera, *, depth: bool = False) -> TruthFrame:
    with TruthRenderer(
        Cell(CellDesign(items=items, lights=DARK)), replace(view, camera=camera), depth=depth
    ) as eye:
        return eye.frame()


def counted(ids: np.ndarray, thing: int) -> dict[str, np.ndarray | float]:
    """Area, centroid, axes and box of a mask in a finer picture, in pixels of the coarse one."""
    n = FINER
    v, u = np.nonzero(ids == thing)
    pixels = (np.stack([u, v], axis=1) + 0.5) / n - 0.5
    spread = np.cov(pixels.T, bias=True) + np.eye(2) / (12 * n * n)
    values, vectors = np.linalg.eigh(spread)
    low, high = pixels.min(axis=0) - 0.5 / n, pixels.max(axis=0) + 0.5 / n
    return {
        "area": len(u) / n**2,
        "centroid": pixels.mean(axis=0),
        "axes": 4 * np.sqrt(values[::-1]),
        "direction": vectors[:, 1],
        "box": np.concatenate([low, high - low]),
    }


@pytest.mark.parametrize("name", CAMERAS)
def test_outlines_hold_against_finer_pictures(name):
    """Against masks of finer pixels: centroid <= 0.05 px, area 1 %, axes 0.1 px, direction 1 deg, box 0.25.

    A lens takes what is hidden from pixels, which leaves 0.25 px there.
    """
    camera = CAMERAS[name]
    view = view_of(camera)
    frame, fine = seen(ITEMS, camera, view), seen(ITEMS, finer(camera), view)
    truth = frame.objects
    alone = {
        "under": seen(ITEMS[1:2], finer(camera), view).ids,
        "cut": fine.ids == 5,
    }
    for i, item in enumerate(ITEMS):
        mask = counted(fine.ids, i + 1)
        exact = item.name != "under" or name == "pinhole"
        assert np.abs(truth.centroid_px[i] - mask["centroid"]).max() < (0.05 if exact else 0.25), item.name
        assert truth.area_px[i] == pytest.approx(mask["area"], rel=0.01 if exact else 0.02), item.name
        assert np.abs(truth.axes_px[i] - mask["axes"]).max() < (0.1 if exact else 1.0), item.name
        assert np.abs(truth.visible_box_px[i] - mask["box"]).max() < (0.25 if exact else 0.6), item.name
        direction = np.array([np.cos(truth.orientation_rad[i]), np.sin(truth.orientation_rad[i])])
        if truth.axes_px[i, 0] > 1.3 * truth.axes_px[i, 1]:
            assert abs(direction @ mask["direction"]) > np.cos(np.radians(1)), item.name
    hidden = 1 - (fine.ids == 2).sum() / (alone["under"] == 1).sum()
    assert 0.1 < hidden < 0.6
    assert truth.occluded[1] == pytest.approx(hidden, abs=0.02)
    assert truth.amodal_area_px[1] == pytest.approx((alone["under"] == 1).sum() / FINER**2, rel=0.01)
    assert (truth.occluded[[0, 2, 3]] < 0.005).all()
    if name == "pinhole":
        assert 0.1 < truth.truncated[4] < 0.9
        assert truth.occluded[4] == pytest.approx(truth.truncated[4], abs=1e-9)
        assert (
            truth.amodal_box_px[4, 0] + truth.amodal_box_px[4, 2] > 239.5 or truth.amodal_box_px[4, 1] < -0.5
        )


def ellipse_centre(camera: Camera, cam_from_disc: SE3, radius: float) -> np.ndarray:
    """Centre of the picture of a circle: the pole of the line at infinity of its conic."""
    H = camera.K @ np.stack(
        [cam_from_disc.rotation[:, 0], cam_from_disc.rotation[:, 1], cam_from_disc.translation], axis=1
    )
    dual = H @ np.diag([radius**2, radius**2, -1.0]) @ H.T
    return dual[:2, 2] / dual[2, 2]


@pytest.mark.parametrize("tilt", [0.0, 0.3, 0.6])
def test_centroid_of_an_unhidden_disc(tilt):
    """Within 0.05 px of the ellipse's centre in closed form; the disc's middle is imaged elsewhere."""
    disc = Item("disc", "disc", (0.08, 0.001), x_m=0.03, y_m=-0.02, fixed=True)
    camera = Camera(640, 480, 600, 600, 319.5, 239.5)
    view = look_at(camera, (-0.8 * np.sin(tilt), 0.0, 0.8 * np.cos(tilt)))
    frame = seen((disc,), camera, view)
    middle = view.cam_from_station @ SE3(np.eye(3), np.array([0.03, -0.02, 0.0005]))
    centroid = frame.objects.centroid_px[0]
    assert np.abs(centroid - ellipse_centre(camera, middle, 0.04)).max() < 0.05
    v, u = np.nonzero(frame.ids == 1)
    assert np.abs(centroid - [u.mean(), v.mean()]).max() < 0.05
    bias = np.abs(centroid - camera.project(middle.translation)).max()
    assert frame.objects.centre_px[0] == pytest.approx(camera.project(middle.translation))
    assert (bias > 0.2) == (tilt > 0)  # perspective, and none when the disc faces the camera


@pytest.mark.parametrize("name", CAMERAS)
def test_masks_are_the_same_with_and_without_depth(name):
    """Leaving table and floor out of the draw changes no mask."""
    camera = CAMERAS[name]
    view = view_of(camera)
    one, two = seen(ITEMS, camera, view), seen(ITEMS, camera, view, depth=True)
    assert (one.ids == two.ids).all()
    assert one.depth is None
    assert two.depth is not None
    assert np.abs(one.objects.occluded - two.objects.occluded).max() < 1e-9
    assert set(np.unique(one.ids)) == {0, 1, 2, 3, 4, 5}


def test_what_is_not_seen_has_no_numbers_but_a_place():
    items = (Item("far", x_m=5.0, fixed=True), Item("under", "disc", (0.02, 0.002), fixed=True))
    lid = Item("lid", "box", (0.1, 0.1, 0.02), above_m=0.01, fixed=True, tracked=False)
    frame = seen((*items, lid), PINHOLE, view_of(PINHOLE))
    truth = frame.objects
    assert truth.names == ("far", "under")  # clutter hides but is not told about
    assert np.isnan(truth.centroid_px).all()
    assert np.isnan(truth.visible_box_px).all()
    assert (truth.area_px == 0).all()
    assert (truth.occluded == 1).all()
    assert truth.truncated[0] == 1
    assert truth.truncated[1] == 0
    assert np.isfinite(truth.amodal_box_px[1]).all()
    assert truth.station_from_object.translation[0, 0] == 5.0
    assert not (frame.ids > 0).any()


def test_the_label_is_a_thing_and_the_arm_hides():
    """The hand's label is tracked, and a rod under the forearm is occluded by it."""
    design = CellDesign(
        items=(Item("rod", "rod", y_m=0.06, yaw_rad=np.pi / 2, fixed=True),), arm=ArmMount(), lights=DARK
    )
    cell = Cell(design)
    with TruthRenderer(cell, look_at(PINHOLE, (0.0, 0.0, 0.75))) as eye:
        away = eye.frame().objects
        cell.pose_arm(np.array([0.12, 0.3, -0.6, 0, 0.0]))
        over = eye.frame()
    assert cell.tracked == ("rod", "label")
    assert away.occluded[0] == pytest.approx(0, abs=1e-9)
    assert away.occluded[1] == 1
    assert over.objects.occluded[0] > 0.05
    assert over.objects.area_px[1] > 20
    assert (over.ids == 2).sum() == pytest.approx(over.objects.area_px[1], abs=12)
    v, u = np.nonzero(over.ids == 2)
    colour = over.image[v, u].mean(axis=0)
    assert colour[0] > 3 * colour[1]  # magenta: much blue and red, little green
    assert colour[2] > 3 * colour[1]


def test_another_place_of_the_camera():
    cell = Cell(CellDesign(items=ITEMS, lights=DARK))
    view = view_of(PINHOLE)
    nudge = SE3.from_rotvec(np.array([0.0, 0.0, 0.02]), np.array([0.004, 0, 0]))
    with TruthRenderer(cell, view) as eye:
        shaken = eye.frame(nudge @ view.cam_from_station)
    with TruthRenderer(cell, replace(view, cam_from_station=nudge @ view.cam_from_station)) as eye:
        moved = eye.frame()
    assert np.allclose(shaken.objects.centroid_px, moved.objects.centroid_px)
    assert (np.abs(shaken.image.astype(int) - moved.image) > 1).mean() < 1e-3
    assert (shaken.ids == moved.ids).all()


def test_velocity_and_pose_are_in_the_station():
    turned = SE3.from_rotvec(np.array([0, 0, 1.1]), np.array([0.3, 0.1, 0.07]))
    item = Item("a", path=Straight((0.0, 0.0, 0.0, 0.2), (0.1, -0.05, 0.0, 0.4)))
    cell = Cell(CellDesign(items=(item,), base_from_station=turned, lights=DARK))
    cell.at(0.5)
    with TruthRenderer(cell, view_of(PINHOLE)) as eye:
        truth = eye.frame().objects
    assert truth.velocity[0] == pytest.approx([0.1, -0.05, 0, 0, 0, 0.4])
    assert truth.station_from_object.translation[0] == pytest.approx([0.05, -0.025, 0.004])
