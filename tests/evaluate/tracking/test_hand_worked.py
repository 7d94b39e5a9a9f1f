"""Tracking metrics on cases small enough to count by hand, and the laws they obey."""

import numpy as np
import pytest

from tests.evaluate.tracking.made_tracks import tracks, wandering
from vision_robot.errors import BadTable
from vision_robot.evaluate.tracking import (
    box_overlap,
    clear_scores,
    closeness,
    encounters,
    hota_scores,
    identity_scores,
    localisation_scores,
    occlusion_scores,
    single_object_scores,
)
from vision_robot.evaluate.tracking.localisation import yaw_difference
from vision_robot.tracks import Tracks


def walk(ids: list[int], start: int = 0) -> list[tuple[int, int, float, float]]:
    """One object walking right, named `ids[k]` in frame k."""
    return [(start + k, label, 10.0 * k, 0.0) for k, label in enumerate(ids)]


@pytest.mark.parametrize(
    ("a", "b", "overlap"),
    [
        ([0, 0, 2, 2], [0, 0, 2, 2], 1),
        ([0, 0, 2, 2], [1, 0, 2, 2], 1 / 3),
        ([0, 0, 2, 2], [2, 0, 2, 2], 0),
        ([0, 0, 4, 4], [1, 1, 2, 2], 1 / 4),
        ([0, 0, 0, 0], [0, 0, 0, 0], 0),
    ],
)
def test_overlap_of_boxes(a, b, overlap):
    assert box_overlap(np.array([a], float), np.array([b], float))[0, 0] == pytest.approx(overlap)


def test_closeness_falls_to_zero():
    near = closeness(np.zeros((1, 2)), np.array([[0.0, 0], [3, 4], [30, 40]]), 10)
    assert np.allclose(near, [[1, 0.5, 0]])


def test_clear_counts_a_switch_once():
    """Ten frames, the answer renamed after five, one frame missed, one false alarm."""
    answer = walk([7] * 5 + [8] * 5)
    del answer[2]
    answer.append((4, 99, 300.0, 300.0))
    found = clear_scores(encounters(tracks(walk([1] * 10)), tracks(answer)))
    assert (found.hits, found.misses, found.false_alarms, found.switches) == (9, 1, 1, 1)
    assert found.mota == pytest.approx(1 - 3 / 10)
    assert found.motp == pytest.approx(1)
    assert found.recall == pytest.approx(0.9)
    assert found.precision == pytest.approx(0.9)


def test_identity_keeps_the_longer_name():
    found = identity_scores(encounters(tracks(walk([1] * 10)), tracks(walk([7] * 6 + [8] * 4))))
    assert found.explained == 6
    assert found.idf1 == pytest.approx(0.6)


def test_hota_of_a_track_renamed_in_the_middle():
    """Every row is found (DetA 1); each row's pair shares 5 of 10 rows (AssA 1/2): HOTA sqrt(1/2)."""
    found = hota_scores(encounters(tracks(walk([1] * 10)), tracks(walk([7] * 5 + [8] * 5))))
    assert found.deta == pytest.approx(1)
    assert found.assa == pytest.approx(0.5)
    assert found.hota == pytest.approx(np.sqrt(0.5))


@pytest.mark.parametrize("seed", range(5))
def test_the_truth_itself_is_perfect_and_names_do_not_matter(seed):
    truth, _ = wandering(seed)
    renamed = Tracks(**{**{name: getattr(truth, name) for name in FIELDS}, "id": 50 - truth.id})
    seen = encounters(truth, renamed)
    assert hota_scores(seen).hota == pytest.approx(1)
    assert clear_scores(seen).mota == 1
    assert identity_scores(seen).idf1 == 1


FIELDS = (
    "frame",
    "time_s",
    "centroid_px",
    "box_px",
    "area_px",
    "axes_px",
    "yaw_rad",
    "position_m",
    "velocity_m_s",
)


def test_no_answer_at_all():
    seen = encounters(tracks(walk([1] * 4)), Tracks.empty())
    assert hota_scores(seen).hota == 0
    assert clear_scores(seen).mota == 0
    assert identity_scores(seen).idf1 == 0
    assert localisation_scores(seen).recall == 0
    assert single_object_scores(seen, 1).success_auc == 0
    assert single_object_scores(seen, 1).precision_auc == 0


def test_success_and_precision_by_hand():
    """Boxes of side 10, half a box to the side in every frame: overlap 1/3, 5 px away."""
    shifted = [(f, i, u + 5, v) for f, i, u, v in walk([1] * 4)]
    found = single_object_scores(encounters(tracks(walk([1] * 4)), tracks(shifted)), 1)
    assert found.success_auc == pytest.approx(7 / 21)  # 0, 0.05 ... 0.30
    assert found.precision_auc == pytest.approx(46 / 51)  # 5 ... 50 px
    assert found.precision_20 == 1


def test_localisation_takes_the_nearest_pairs():
    truth = tracks([(0, 1, 0, 0), (0, 2, 30, 0), (1, 1, 0, 0), (1, 2, 500, 0)])
    answer = tracks([(0, 5, 31, 0), (0, 6, 3, 0), (1, 5, 5, 0)])
    found = localisation_scores(encounters(truth, answer))
    assert found.centroid_error_px == pytest.approx(3)  # of 1, 3 and 5
    assert found.recall == pytest.approx(3 / 4)
    assert np.isnan(found.yaw_error_rad)


@pytest.mark.parametrize(
    ("a", "b", "apart"), [(0, 180, 0), (10, 170, 20), (89, -89, 2), (0, 90, 90), (725, 0, 5)]
)
def test_yaw_has_no_head(a, b, apart):
    assert np.degrees(yaw_difference(np.radians([a]), np.radians([b])))[0] == pytest.approx(apart, abs=1e-9)


def test_an_object_found_again_after_hiding():
    """Hidden in frames 3 to 5; the answer is back in frame 8, two frames late, with its old name."""
    truth = tracks(walk([1] * 10), occluded=[0, 0, 0, 1, 1, 1, 0, 0, 0, 0])
    answer = [row for row in walk([4] * 10) if row[0] not in (3, 4, 6, 7)]
    found = occlusion_scores(encounters(truth, tracks(answer)))
    assert found.episodes == 1
    assert found.recall == pytest.approx(1 / 3)
    assert found.reacquisition_s == pytest.approx(0.2)
    assert found.kept_identity == 1
    renamed = occlusion_scores(encounters(truth, tracks([(f, 4 + (f > 5), u, v) for f, _, u, v in answer])))
    assert renamed.kept_identity == 0


def test_tables_that_cannot_be_compared_are_refused():
    twice = tracks([(0, 1, 0, 0), (0, 1, 5, 0)])
    with pytest.raises(BadTable, match="id 1 stands more than once in frame 0"):
        encounters(twice, twice)
    boxless = Tracks.from_csv("frame,id,u_px,v_px\n0,1,5,5\n")
    with pytest.raises(BadTable, match="frame 0"):
        encounters(boxless, boxless)
    with pytest.raises(BadTable, match="occluded"):
        occlusion_scores(encounters(tracks(walk([1])), tracks(walk([1]))))
