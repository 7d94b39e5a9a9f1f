"""The interaction matrix is a derivative, and a step inverts it."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from vision_robot.geometry import SE3, WorkPlane
from vision_robot.pick.servo.interaction import ideal, image_step, interaction_matrix, plane_matrix
from vision_robot.pick.world import ordinary_world

VIEW = ordinary_world().view
PLANE = WorkPlane.exact(VIEW.camera, VIEW.cam_from_station)
SIDE = st.floats(-0.1, 0.1)


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(0.3, 2.0))
def test_it_is_the_derivative_of_the_image_of_a_still_point(x, y, depth):
    """For a camera that moves by a small twist (v, w)."""
    point, step = depth * np.array([x, y, 1.0]), 1e-6
    L = interaction_matrix(x, y, depth)
    for i in range(6):
        ends = [SE3.exp(k * step * np.eye(6)[i]).inverse().apply(point[None])[0] for k in (1, -1)]
        images = [end[:2] / end[2] for end in ends]
        assert np.allclose((images[0] - images[1]) / (2 * step), L[:, i], atol=1e-7)


@given(SIDE, SIDE, st.floats(0.0, 0.2))
def test_in_the_plane_it_is_the_derivative_of_the_projection(x, y, height):
    point, step = np.array([x, y, height]), 1e-6
    here = ideal(PLANE, PLANE.pixels(point[None, :2], z_m=height))[0]
    J = plane_matrix(PLANE, here, point)
    for i in range(2):
        ends = point[:2] + step * np.array([1, -1])[:, None] * np.eye(2)[i]
        moved = ideal(PLANE, PLANE.pixels(ends, z_m=height))
        assert np.allclose((moved[0] - moved[1]) / (2 * step), J[:, i], atol=1e-5)


@given(SIDE, SIDE, SIDE, SIDE, st.floats(0.0, 0.2))
def test_two_whole_steps_leave_a_thousandth_of_the_error(x, y, to_x, to_y, height):
    """The mean of both interaction matrices makes one step nearly all of the way; depth is only believed."""
    point, goal = np.array([x, y, height]), np.array([to_x, to_y])
    wanted = PLANE.pixels(goal[None], z_m=height)[0]
    away = np.linalg.norm(goal - point[:2])
    step = image_step(PLANE, point, PLANE.pixels(point[None, :2], z_m=height)[0], wanted)
    assert np.linalg.norm(point[:2] + step - goal) <= 5e-2 * away + 1e-12
    point[:2] += step
    again = image_step(PLANE, point, PLANE.pixels(point[None, :2], z_m=height)[0], wanted)
    assert np.linalg.norm(point[:2] + again - goal) <= 1e-3 * away + 1e-12
