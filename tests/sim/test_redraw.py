"""A region drawn anew gives the picture that drawing all of it gives, and depends on nothing before it."""

import numpy as np
import pytest

from vision_robot.geometry import SE3, Camera
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import ArmMount, Belt, CellDesign, Item, Lights, look_at
from vision_robot.sim.paths import Circle
from vision_robot.sim.truth import TruthRenderer

CAMERA = Camera(320, 240, 300, 300, 159.5, 119.5)
VIEW = look_at(CAMERA, (0, 0, 0.8))
MOVING = (
    Item("led", path=Circle((0.0, 0.05), 0.03, 1.0)),
    Item("free", "box", (0.03, 0.03, 0.03), (0.2, 0.4, 0.8), x_m=0.05),
)
STANDING = (Item("fixed", "box", (0.05, 0.05, 0.05), (0.3, 0.8, 0.3), y_m=-0.1, fixed=True),)


def whole(eye: TruthRenderer) -> np.ndarray:
    """The picture drawn at once."""
    return eye._renderer.render(CAMERA, eye._base_from_cam(None))


@pytest.mark.parametrize("shadows", [False, True])
@pytest.mark.parametrize("arm", [None, ArmMount(start=(0.1, 0.9, -0.9, 0, 0.5))])
def test_it_is_the_same_picture(shadows, arm):
    """No pixel differs by more than rounding, but for a few at edges: nothing is left over, nothing cut."""
    cell = Cell(
        CellDesign(items=(*MOVING, *STANDING), arm=arm, lights=Lights(shadows=shadows, shadow_px=1024))
    )
    with TruthRenderer(cell, VIEW) as eye:
        regions = []
        for time_s in (0.0, 1.0, 2.5, 4.0):
            cell.at(time_s)
            regions.append(eye._moving.region(CAMERA, eye._base_from_cam(None)))
            difference = np.abs(eye.picture().astype(int) - whole(eye)).max(axis=2)
            assert (difference > 2).sum() <= 8
    assert all(region is not None for region in regions)
    assert len(set(regions)) > 1 or arm is not None


def test_it_depends_on_the_present_alone():
    cell = Cell(CellDesign(items=(*MOVING, *STANDING)))
    with TruthRenderer(cell, VIEW) as eye:
        for time_s in (0.3, 2.0, 1.1):
            cell.at(time_s)
            last = eye.picture()
    with TruthRenderer(cell, VIEW) as eye:
        assert (eye.picture() == last).all()


def test_a_shadow_past_the_table_is_inside_the_region():
    """A thing at the table's edge throws its shadow on the floor."""
    lights = Lights(azimuth_rad=np.pi, elevation_rad=0.9, shadow_px=1024)
    led = Item("led", "box", (0.1, 0.1, 0.06), x_m=0.55, above_m=0.1, path=Circle((0.55, 0.0), 0.01, 1.0))
    cell = Cell(CellDesign(items=(led,), lights=lights))
    camera = Camera(320, 240, 90, 90, 159.5, 119.5)
    with TruthRenderer(cell, look_at(camera, (0.8, 0, 0.9), (0.8, 0, 0))) as eye:
        picture = eye.picture()
        straight = eye._renderer.render(camera, eye._base_from_cam(None))
    assert (np.abs(picture.astype(int) - straight).max(axis=2) > 2).sum() <= 8


def test_nothing_moves_or_all_does():
    with TruthRenderer(Cell(CellDesign(items=STANDING)), VIEW) as eye:
        assert eye._moving.region(CAMERA, eye._base_from_cam(None)) == (0, 0, 0, 0)
        assert (eye.picture() == eye.picture()).all()
    with TruthRenderer(Cell(CellDesign(items=MOVING, belt=Belt())), VIEW) as eye:
        assert (eye.picture() == whole(eye)).all()


def test_changed_light_and_another_place_draw_all():
    cell = Cell(CellDesign(items=(*MOVING, *STANDING)))
    nudge = SE3(np.eye(3), np.array([0.01, 0, 0]))
    with TruthRenderer(cell, VIEW) as eye:
        plain = eye.picture()
        cell.set_light(key=0.2, ambient=0.3)
        darker = eye.picture()
        assert (darker == whole(eye)).all()
        assert darker.mean() < 0.8 * plain.mean()
        cell.set_light(key=cell.design.lights.key, ambient=cell.design.lights.ambient)
        assert (eye.picture() == plain).all()
        shaken = eye.picture(nudge @ VIEW.cam_from_station)
        assert (np.abs(shaken.astype(int) - plain) > 5).mean() > 0.02
        cell.set_light(azimuth_rad=0.2, elevation_rad=0.7)
        assert (np.abs(eye.picture().astype(int) - plain) > 5).mean() > 0.001
