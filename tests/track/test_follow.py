"""From blobs to tracks: ids that last, velocities, directions that go on, births and deaths."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.track import Blobs
from vision_robot.track.follow import Follower, FollowOptions
from vision_robot.track.motion import Motion

SIZE = (640, 480)
DT = 0.04


def blobs(
    places: Sequence[tuple[float, float]], yaw: float | Sequence[float] = 0.0, area: float = 300
) -> Blobs:
    n = len(places)
    centre = np.array(places, dtype=float).reshape(-1, 2)
    box = np.concatenate([centre - 10, np.full((n, 2), 20.0)], axis=1)
    return Blobs(centre, box, np.full(n, float(area)), np.tile([40.0, 10.0], (n, 1)), np.broadcast_to(yaw, n))


def followed(frames: Sequence[Blobs], **options) -> list:
    follower = Follower(SIZE, FollowOptions(**options))
    rows = [follower.step(k, k * DT, seen) for k, seen in enumerate(frames)]
    return [part for part in [*rows, *follower.finish()] if len(part)]


def ids_of(rows: list) -> dict[int, list[tuple[int, float, float]]]:
    paths: dict[int, list] = {}
    for part in rows:
        for k, one, (u, v) in zip(
            part.frame.tolist(), part.id.tolist(), part.centroid_px.tolist(), strict=True
        ):
            paths.setdefault(one, []).append((k, u, v))
    return paths


def test_two_that_cross_keep_their_ids_and_every_frame():
    rng = np.random.default_rng(1)
    frames = []
    for k in range(80):
        jitter = rng.normal(0, 0.1, (2, 2))
        places = np.array([(100 + 5 * k, 200 + 0.3 * k), (500 - 5 * k, 212 - 0.2 * k)]) + jitter
        frames.append(blobs([tuple(p) for p in places[:: 1 if k % 2 else -1]]))
    paths = ids_of(followed(frames))
    assert sorted(paths) == [1, 2]
    assert all(len(path) == 80 for path in paths.values())
    for path in paths.values():
        assert len({np.sign(b[1] - a[1]) for a, b in pairwise(path)}) == 1


def test_out_of_sight_and_back_is_the_same_object_and_too_long_is_not():
    def seen(hidden: range) -> list[Blobs]:
        return [blobs([] if k in hidden else [(100 + 4 * k, 240)]) for k in range(90)]

    assert sorted(ids_of(followed(seen(range(30, 48))))) == [1]
    assert sorted(ids_of(followed(seen(range(30, 48)), max_gap_s=0.3))) == [1, 2]


def test_what_flickers_is_no_object_and_leaves_no_gap_in_the_numbers():
    rng = np.random.default_rng(2)
    frames = [
        blobs([(100 + 2 * k, 100), *([tuple(rng.uniform((0, 200), SIZE))] if k % 3 == 0 else [])])
        for k in range(60)
    ]
    frames += [blobs([(220, 100), (500, 300)]) for _ in range(10)]
    assert sorted(ids_of(followed(frames))) == [1, 2]


def test_velocity_and_its_sigma():
    rng = np.random.default_rng(3)
    rows = followed([blobs([(50 + 3 * k + e, 300 - k + e)]) for k, e in enumerate(rng.normal(0, 0.1, 100))])
    late = rows[-40:]
    velocity = np.array([(part.extra["vu_px_s"][0], part.extra["vv_px_s"][0]) for part in late])
    sigma = np.array([part.extra["sigma_v_px_s"][0] for part in late])
    assert np.abs(velocity.mean(axis=0) - [75, -25]).max() < 2
    assert np.sqrt(((velocity - [75, -25]) ** 2).mean()) < sigma.mean() < 1
    assert 0.02 < np.mean([part.extra["sigma_px"][0] for part in late]) < 0.3


def test_a_turn_at_a_sudden_is_survived():
    frames = [blobs([(100 + 6 * min(k, 40), 240 - 6 * max(k - 40, 0))]) for k in range(70)]
    assert sorted(ids_of(followed(frames))) == [1]


@pytest.mark.parametrize("rate", [0.12, -0.2])
def test_yaw_goes_on_past_half_a_turn(rate):
    """The picture tells an axis modulo pi; two turns are four halves."""
    yaw = rate * np.arange(100)
    seen = [blobs([(300, 240)], (angle + np.pi / 2) % np.pi - np.pi / 2) for angle in yaw]
    rows = followed(seen)
    assert np.allclose(np.unwrap([part.yaw_rad[0] for part in rows]), yaw + rows[0].yaw_rad[0], atol=1e-9)
    assert rows[-1].yaw_rad[0] == pytest.approx(yaw[-1])
    assert rows[-1].extra["turn_deg_s"][0] == pytest.approx(np.degrees(rate / DT), rel=0.01)


def test_kinds_are_never_mixed():
    def seen(k: int) -> Blobs:
        both = blobs([(200 + k, 200), (202 + k, 200)])
        return Blobs(
            both.centroid_px, both.box_px, both.area_px, both.axes_px, both.yaw_rad, kind=np.array([0, 1])
        )

    rows = followed([seen(k) for k in range(30)])
    kinds = {
        (int(i), int(kind)) for part in rows for i, kind in zip(part.id, part.extra["kind"], strict=True)
    }
    assert len(kinds) == 2


def test_no_more_objects_than_there_are():
    rows = followed([blobs([(100, 100), (300, 300), (500, 200)]) for _ in range(10)], max_objects=2)
    assert sorted(ids_of(rows)) == [1, 2]


def test_the_gate_is_a_chi_squared_one():
    """0.1 % of true positions fall outside: the covariance is the one of what was simulated."""
    rng = np.random.default_rng(4)
    n = 20000
    motion = Motion.start(np.zeros((n, 2)), np.full(n, 0.5), np.full(n, 20.0), 100.0)
    truth = (
        rng.normal(0, 0.5, (n, 2)) + DT * rng.normal(0, 20, (n, 2)) + DT**2 / 2 * rng.normal(0, 100, (n, 2))
    )
    seen = truth + rng.normal(0, 0.5, (n, 2))
    spread = motion.predicted(DT).distance(np.zeros((1, 2)), np.full(1, 0.5))
    assert spread.max() == 0
    after = motion.predicted(DT)
    scaled = (seen**2).sum(axis=1) / (after.covariance[:, 0, 0] + 0.25)
    assert 0.0004 < (scaled > 13.82).mean() < 0.0018
    updated = after.updated(seen, np.full(n, 0.5), 0.0, learn=np.zeros(n, dtype=bool))
    left = (updated.position - truth).std()
    assert left == pytest.approx(np.sqrt(updated.covariance[0, 0, 0]), rel=0.03)


def test_nothing_comes_of_nothing():
    assert followed([blobs([]) for _ in range(5)]) == []
    for bad in ({"confirm": 0}, {"max_gap_s": -1}, {"max_objects": 0}):
        with pytest.raises(BadParameter):
            FollowOptions(**bad)
