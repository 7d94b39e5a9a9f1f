"""HOTA, CLEAR MOT and identity scores are those of TrackEval, to 1e-9, on tracks full of mistakes."""

import numpy as np
import pytest

from tests.evaluate.tracking.made_tracks import wandering
from vision_robot.evaluate.tracking import clear_scores, encounters, hota_scores, identity_scores

metrics = pytest.importorskip("trackeval.metrics")

SEEDS = range(60)


def oracle(metric: str, seen) -> dict:
    """TrackEval's own figures for the same encounters."""
    data = {
        "num_timesteps": len(seen.frames),
        "gt_ids": seen.truth_ids,
        "tracker_ids": seen.answer_ids,
        "similarity_scores": seen.similarity,
        "num_gt_dets": len(seen.truth),
        "num_tracker_dets": len(seen.answer),
        "num_gt_ids": seen.truth_objects,
        "num_tracker_ids": seen.answer_objects,
    }
    # TrackEval 1.3 prints its settings unless told not to, except that HOTA takes none.
    return getattr(metrics, metric)(*([] if metric == "HOTA" else [{"PRINT_CONFIG": False}])).eval_sequence(
        data
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_hota(seed):
    seen = encounters(*wandering(seed))
    if not len(seen.truth) or not len(seen.answer):
        pytest.skip("nothing to compare")
    ours, theirs = hota_scores(seen), oracle("HOTA", seen)
    assert ours.hota == pytest.approx(theirs["HOTA"].mean(), abs=1e-9)
    assert np.allclose(ours.detection, theirs["DetA"], atol=1e-9)
    assert np.allclose(ours.association, theirs["AssA"], atol=1e-9)
    assert np.allclose(ours.localisation, theirs["LocA"], atol=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_clear_mot(seed):
    seen = encounters(*wandering(seed))
    if not len(seen.truth) or not len(seen.answer):
        pytest.skip("nothing to compare")
    ours, theirs = clear_scores(seen), oracle("CLEAR", seen)
    counts = (ours.hits, ours.misses, ours.false_alarms, ours.switches)
    assert counts == tuple(int(theirs[name]) for name in ("CLR_TP", "CLR_FN", "CLR_FP", "IDSW"))
    assert ours.mota == pytest.approx(theirs["MOTA"], abs=1e-9)
    if ours.hits:
        assert ours.motp == pytest.approx(theirs["MOTP"], abs=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_identity(seed):
    seen = encounters(*wandering(seed))
    if not len(seen.truth) or not len(seen.answer):
        pytest.skip("nothing to compare")
    ours, theirs = identity_scores(seen), oracle("Identity", seen)
    assert ours.idf1 == pytest.approx(theirs["IDF1"], abs=1e-9)
    assert ours.recall == pytest.approx(theirs["IDR"], abs=1e-9)
    assert ours.precision == pytest.approx(theirs["IDP"], abs=1e-9)
