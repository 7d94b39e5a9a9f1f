"""Rendered pictures, depths and ids lie where the camera model puts them, whatever the lens."""

import cv2
import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.geometry import SE3, Camera, pixel_grid, plane_from_pixels
from vision_robot.sim.cover import PinholeCover
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.render import Renderer

OFF_CENTRE = Camera(160, 120, 150.0, 135.0, 61.3, 70.8)
BROWN5 = Camera(160, 120, 120, 125, 71.3, 64.8, 2.0, "brown5", (-0.25, 0.08, 0.001, -0.002, 0.0))
FISHEYE = Camera(160, 160, 42, 42, 76.0, 82.0, 0.0, "fisheye", (-0.01, 0.002, 0.0, 0.0))
CAMERAS = [OFF_CENTRE, BROWN5, FISHEYE]
IDS = ["off-centre", "brown5", "fisheye"]

# A slab whose upper face is z = 0, with a red half (x < 0) and a blue one.
SLAB = """
<mujoco>
  <option jacobian="dense"/>
  <statistic extent="1" center="0 0 0"/>
  <visual><map znear="0.01" zfar="20"/></visual>
  <asset>
    <material name="red" rgba="0.4 0 0 1" specular="0" shininess="0"/>
    <material name="blue" rgba="0 0 0.4 1" specular="0" shininess="0"/>
  </asset>
  <worldbody>
    <light pos="0.3 0.3 1" dir="-0.3 -0.3 -1" castshadow="true"/>
    <geom type="box" size="0.2 0.3 0.01" pos="-0.2 0 -0.01" material="red"/>
    <geom type="box" size="0.2 0.3 0.01" pos="0.2 0 -0.01" material="blue"/>
    <geom type="sphere" size="0.03" pos="0.15 0.1 0.15" rgba="0 0.9 0 1"/>
  </worldbody>
</mujoco>
"""
# Looking down (camera z along -z of the world), a little askew.
CAM_FROM_WORLD = SE3.from_rotvec(np.array([np.pi, 0, 0]), np.zeros(3)) @ SE3.from_rotvec(
    np.array([0.2, -0.15, 0.3]), np.array([0.02, -0.03, -0.5])
)
WORLD_FROM_CAM = CAM_FROM_WORLD.inverse()


def slab(sphere: bool = False):
    mj = load_mujoco()
    model = mj.MjModel.from_xml_string(SLAB)
    if not sphere:
        model.geom_rgba[2, 3] = 0
        model.geom_size[2] = 1e-6
    data = mj.MjData(model)
    mj.mj_forward(model, data)
    return model, data


def on_face(camera: Camera, margin: float):
    """Position on z = 0 of each pixel, and whether it lies on the slab, `margin` [m] from its border."""
    xy = plane_from_pixels(camera, CAM_FROM_WORLD, pixel_grid(camera.width, camera.height))
    with np.errstate(invalid="ignore"):
        return xy, (np.abs(xy[..., 0]) < 0.4 - margin) & (np.abs(xy[..., 1]) < 0.3 - margin)


@pytest.mark.parametrize("camera", CAMERAS, ids=IDS)
def test_depth_is_where_rays_meet_the_face(camera):
    """Every pixel well inside the face has the depth of the ray through its centre."""
    with Renderer(*slab()) as renderer:
        depth = renderer.depth(camera, WORLD_FROM_CAM)
    xy, inside = on_face(camera, 0.03)
    points = np.concatenate([xy[inside], np.zeros((inside.sum(), 1))], axis=1)
    assert inside.sum() > 1500
    assert np.abs(depth[inside] / CAM_FROM_WORLD.apply(points)[:, 2] - 1).max() < 2e-4
    rays = camera.unproject(pixel_grid(camera.width, camera.height))
    assert (np.isnan(depth) == np.isnan(rays[..., 0])).all()
    outside = ~on_face(camera, -0.05)[1] & ~np.isnan(depth)
    assert np.isinf(depth[outside]).all()


@pytest.mark.parametrize("camera", CAMERAS, ids=IDS)
def test_ids_and_colours_are_where_rays_meet_the_face(camera):
    """Left half red with id 0, right half blue with id 1, nothing around; blue-green-red order."""
    geom = int(load_mujoco().mjtObj.mjOBJ_GEOM)
    with Renderer(*slab()) as renderer:
        ids = renderer.segmentation(camera, WORLD_FROM_CAM)
        image = renderer.render(camera, WORLD_FROM_CAM)
        grey = renderer.render(camera, WORLD_FROM_CAM, grey=True)
    xy, inside = on_face(camera, 0.01)
    with np.errstate(invalid="ignore"):
        left, right = inside & (xy[..., 0] < -0.01), inside & (xy[..., 0] > 0.01)
    assert (ids[left] == (0, geom)).all()
    assert (ids[right] == (1, geom)).all()
    assert (ids[~on_face(camera, -0.05)[1]] == -1).all()
    assert image.shape == (camera.height, camera.width, 3)
    assert (image[left][:, 2] > 20).all()
    assert (image[left][:, :2] < 10).all()
    assert (image[right][:, 0] > 20).all()
    assert (image[right][:, 1:] < 10).all()
    assert grey.shape == (camera.height, camera.width)
    assert (grey[left] > 0).all()


def test_edge_between_the_halves_is_at_its_pixel():
    """The red share of a row's light puts the edge x = 0 at its analytic column to 0.02 px."""
    for camera in (OFF_CENTRE, Camera(160, 120, 150, 135, 95.6, 48.1)):
        level = SE3.from_rotvec(np.array([np.pi, 0, 0]), np.array([0.0313, 0.011, 0.5]))
        with Renderer(*slab(), multisamples=8) as renderer:
            image = renderer.render(camera, level.inverse()).astype(float)
        edge_u, edge_v = camera.project(level.apply(np.array([[0.0, 0, 0]])))[0]
        row = image[round(edge_v), round(edge_u) - 5 : round(edge_u) + 6]
        red, full = row[:, 2], row[0, 2]
        assert abs((red / full).sum() - 0.5 + round(edge_u) - 5 - edge_u) < 0.13  # a sample of eight


def test_wide_fisheye_is_whole():
    """All cube faces meet without a gap: a sky of one colour fills the whole field, black around it."""
    mj = load_mujoco()
    sky = (
        '<mujoco><asset><texture type="skybox" builtin="flat" width="8" height="8"'
        ' rgb1="1 0 0" rgb2="1 0 0"/></asset></mujoco>'
    )
    model = mj.MjModel.from_xml_string(sky)
    data = mj.MjData(model)
    mj.mj_forward(model, data)
    camera = Camera(200, 200, 30, 30, 99.5, 99.5, model="fisheye", distortion=(0, 0, 0, 0))
    with Renderer(model, data) as renderer:
        image = renderer.render(camera, SE3.identity())
    seen = np.isfinite(camera.unproject(pixel_grid(200, 200))[..., 0])
    assert 0.6 < seen.mean() < 0.8
    whole = cv2.erode(seen.astype(np.uint8), np.ones((3, 3))) > 0  # a border pixel is lit in part
    assert (image[whole] == (0, 0, 255)).all()
    assert (image[~seen] == 0).all()
    assert len(PinholeCover.of(camera).faces) == 6


def test_cover_is_one_picture_for_an_ordinary_lens_and_fine_enough():
    """One picture, at least 1.4 of its pixels for every pixel of the camera, everywhere."""
    cover = PinholeCover.of(BROWN5)
    ((face, turn),) = cover.faces
    assert np.allclose(turn.as_matrix(), np.eye(4))
    pixels = face.project(BROWN5.unproject(pixel_grid(160, 120)))
    assert np.linalg.norm(np.diff(pixels, axis=1), axis=-1).min() > 1.4
    assert np.linalg.norm(np.diff(pixels, axis=0), axis=-1).min() > 1.4
    assert (pixels > 1).all()
    assert (pixels < (face.width - 2, face.height - 2)).all()


def test_shadows_darken_only_when_asked_for():
    model, data = slab(sphere=True)
    with Renderer(model, data) as renderer:
        plain = renderer.render(OFF_CENTRE, WORLD_FROM_CAM, grey=True)
    with Renderer(model, data, shadows=True) as renderer:
        shaded = renderer.render(OFF_CENTRE, WORLD_FROM_CAM, grey=True)
    darker = (plain.astype(int) - shaded > 5).sum()
    assert 20 < darker < 3000


def test_the_same_scene_gives_the_same_bytes():
    with Renderer(*slab()) as renderer:
        first, again = (renderer.render(BROWN5, WORLD_FROM_CAM) for _ in range(2))
    with Renderer(*slab()) as renderer:
        renderer.render(Camera(400, 300, 200, 200, 200, 150), WORLD_FROM_CAM)  # a larger buffer
        anew = renderer.render(BROWN5, WORLD_FROM_CAM)
    assert (first == again).all()
    assert (first == anew).all()


def test_a_closed_renderer_says_so():
    renderer = Renderer(*slab())
    renderer.close()
    renderer.close()
    with pytest.raises(BadParameter, match="closed"):
        renderer.render(OFF_CENTRE, WORLD_FROM_CAM)
    with pytest.raises(BadParameter, match="multisamples"):
        Renderer(*slab(), multisamples=3)
