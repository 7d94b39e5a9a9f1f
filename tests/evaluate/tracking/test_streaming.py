"""Streaming: an answer counts from when it is there, and a slow method answers for frames long past."""

from dataclasses import replace

import numpy as np
import pytest

from tests.evaluate.tracking.made_tracks import tracks
from vision_robot.evaluate.tracking import encounters
from vision_robot.evaluate.tracking.figures import tracking_figures
from vision_robot.evaluate.tracking.localisation import localisation_scores
from vision_robot.evaluate.tracking.streaming import answered_frames, streamed

TIMES = np.arange(10) / 10


@pytest.mark.parametrize(
    ("latency", "expected"),
    [
        (0.0, [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]),
        (0.05, [-1, 0, 1, 2, 3, 4, 5, 6, 7, 8]),
        # 0 is done at 0.25, then 2 (taken at 0.25) at 0.50, 5 at 0.75, 7 at 1.00.
        (0.25, [-1, -1, -1, 0, 0, 2, 2, 2, 5, 5]),
        (9.0, [-1] * 10),
    ],
)
def test_which_answer_is_there(latency, expected):
    assert answered_frames(TIMES, np.full(10, latency)).tolist() == expected


def test_a_late_answer_is_off_by_the_way_gone_meanwhile():
    """10 px a frame, answers one frame late: 10 px off, and nothing at all for the first."""
    truth = tracks([(k, 1, 10.0 * k, 0.0) for k in range(10)])
    late = streamed(truth, TIMES, np.full(10, 0.05))
    found = localisation_scores(encounters(truth, late))
    assert found.centroid_error_px == pytest.approx(10)
    assert found.recall == pytest.approx(0.9)
    assert late.time_s[0] == pytest.approx(0.1)


def test_the_figures_have_the_names_of_the_benchmark():
    truth = tracks([(k, 1, 10.0 * k, 0.0) for k in range(10)], occluded=[0, 0, 1, 1, 0, 0, 0, 0, 0, 0])
    figures = tracking_figures(truth, truth)
    assert figures["hota"] == figures["mota"] == figures["recall"] == pytest.approx(1)
    assert figures["occlusion_recall"] == 1
    assert figures["reacquisition_s"] == 0
    assert np.isnan(figures["centroid_error_mm"])


def test_what_nobody_sees_need_not_be_found_and_may_be_guessed():
    """Hidden in frames 4 and 5, where the truth has no visible centroid but tells the centre."""
    hidden = [0.0] * 4 + [1.0] * 2 + [0.0] * 4
    rows = [(k, 1, 10.0 * k, 0.0) for k in range(10)]
    truth = tracks(rows, occluded=hidden)
    names = [f"amodal_{side}_px" for side in ("left", "top", "width", "height")]
    stand_in = np.column_stack([truth.centroid_px, truth.box_px]).T.copy()
    truth = replace(
        truth,
        extra={**truth.extra, **dict(zip(["centre_u_px", "centre_v_px", *names], stand_in, strict=True))},
    )
    truth.centroid_px[4:6] = truth.box_px[4:6] = np.nan
    for answer in (tracks(rows), tracks([row for row in rows if row[0] not in (4, 5)])):
        figures = tracking_figures(truth, answer)
        assert figures["hota"] == figures["mota"] == figures["recall"] == pytest.approx(1)
    assert figures["occlusion_recall"] == 0
