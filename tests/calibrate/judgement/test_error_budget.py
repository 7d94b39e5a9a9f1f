"""The error budget, each cause switched on alone: the right line dominates, the total is the true error."""

import numpy as np
import pytest

from tests.views import CAMERAS, Views, make_views
from vision_robot.calibrate import Corners, Settings, calibrate
from vision_robot.calibrate.judgement.error_budget import error_budget
from vision_robot.calibrate.judgement.picture import Picture
from vision_robot.errors import BadParameter
from vision_robot.geometry import Camera

SIZE = (1280, 960)
NOISE_PX = 0.1
WIDE = Camera(1280, 960, 760, 762, 650, 470, 0, "brown8", (0.9, 0.2, 5e-4, -3e-4, 0.01, 1.25, 0.45, 0.03))


def budget(views: Views, corners: list[Corners], **options):
    settings = Settings(model="brown5", robust=False, **options)
    result = calibrate(corners, views.board, SIZE, settings)
    picture = Picture.of(views.camera)
    true = np.sqrt(picture.mean_square(picture.difference(result.camera)))
    return error_budget(result, views.board, distance_m=0.6), true


def bent(views: Views) -> list[Corners]:
    """A board 0.2 mm rms off its plane: a bow with a twist."""
    x, y = (views.board[:, :2] - views.board[:, :2].mean(axis=0)).T / 0.15
    bow = x**2 + 0.5 * x * y - 0.3 * y**2
    bow = 2e-4 * (bow - bow.mean()) / bow.std()
    return seen(views, lambda _: views.board + np.outer(bow, [0, 0, 1]), lambda pixels, _: pixels)


def wobbling(views: Views) -> list[Corners]:
    """Each view's corners are off by a smooth field of its own, 0.3 px rms."""

    def moved(pixels, rng):
        q = (pixels - pixels.mean(axis=0)) / np.ptp(pixels, axis=0) * 2
        field = np.column_stack([q, q[:, 0] * q[:, 1], q**2]) @ rng.normal(size=(5, 2))
        return pixels + 0.3 * field / np.sqrt(np.mean(field**2))

    return seen(views, lambda _: views.board, moved)


def seen(views: Views, board, moved) -> list[Corners]:
    rng = np.random.default_rng(5)
    corners = []
    for i in range(len(views.corners)):
        pixels = moved(views.camera.project(views.cam_from_board[i].apply(board(i))), rng)
        noisy = pixels + NOISE_PX * rng.normal(size=pixels.shape)
        corners.append(Corners(f"view {i}", np.arange(len(pixels)), noisy))
    return corners


@pytest.fixture(scope="module")
def views():
    return make_views(CAMERAS["brown5"], 20, seed=1, noise_px=NOISE_PX)


def test_noise_alone(views):
    found, true = budget(views, views.corners)
    assert found.dominant is found.noise
    assert [line.px for line in found.lines[1:]] == [0, 0, 0]
    assert 0.4 * found.total_px < true < 2 * found.total_px
    assert "0.1" in found.noise.note


def test_a_bent_board(views):
    found, true = budget(views, bent(views))
    assert found.dominant is found.board
    assert found.board.px > 5 * max(found.noise.px, found.lens.px, found.rest.px)
    assert found.total_px == pytest.approx(true, rel=0.25)
    assert found.total_px < found.board.at_most_px
    plain, _ = budget(views, views.corners)
    assert found.noise.px == pytest.approx(plain.noise.px, rel=0.15)  # the bend is not counted as noise


def test_the_board_set_free_costs_little(views):
    found, true = budget(views, bent(views), warp=3)
    assert found.board.px < found.noise.px
    assert true < 3 * found.total_px


def test_a_lens_too_simple():
    views = make_views(WIDE, 30, seed=1, noise_px=NOISE_PX)
    found, _ = budget(views, views.corners)
    assert found.dominant is found.lens
    assert found.lens.px > 1.5 * max(found.noise.px, found.board.px, found.rest.px)


def test_errors_shared_within_views(views):
    found, true = budget(views, wobbling(views))
    assert found.dominant is found.rest
    assert found.rest.px > 2 * max(found.noise.px, found.board.px, found.lens.px)
    assert 0.3 * found.total_px < true < 3 * found.total_px


def test_mm_are_px_over_the_focal_length_times_the_distance(views):
    """Roughly: the lens stretches a little, and away from the axis the plane is farther off."""
    result = calibrate(views.corners, views.board, SIZE)
    near, far = (error_budget(result, views.board, distance_m=d) for d in (0.5, 1.5))
    assert far.noise.mm == pytest.approx(3 * near.noise.mm)
    assert near.noise.mm == pytest.approx(near.noise.px / 1000 * 500, rel=0.6)
    assert near.noise.px == far.noise.px
    with pytest.raises(BadParameter, match="distance"):
        error_budget(result, views.board, distance_m=0.0)


def test_a_lens_with_nothing_richer_says_so(views):
    result = calibrate(views.corners, views.board, SIZE, Settings(model="brown8"))
    found = error_budget(result, views.board)
    assert np.isnan(found.lens.at_most_px)
    assert "nothing richer" in found.lens.note
