"""Variants of methods: told by their names, kept out of rankings, compared with the method as it is."""

import numpy as np
import pytest

from tests.evaluate.made_outcomes import outcomes
from vision_robot.evaluate.sensitivity import Variant, sensitivities, variant, without_variants

TABLE = {
    "rgb": [0.8, 0.82],
    "rgb:min_area_px=x2": [0.7, 0.72],
    "rgb:min_area_px=x0.5": [0.4, 0.42],
    "rgb:closing_px=3": [0.79, 0.81],
    "klt": [0.3, 0.3],
}


def test_a_name_tells_its_variant():
    assert variant("rgb:min_area_px=x0.5") == Variant("rgb", "min_area_px", "x0.5")
    assert Variant("rgb", "min_area_px", "x0.5").number == 0.5
    assert np.isnan(Variant("rgb", "mode", "fast").number)
    assert variant("rgb-plain") is None
    assert {one.cell.method for one in without_variants(outcomes(TABLE))} == {"rgb", "klt"}


def test_the_most_sensitive_first_and_values_in_order():
    first, second = sensitivities(outcomes(TABLE), "success_auc")
    assert (first.method, first.parameter, first.values) == ("rgb", "min_area_px", ("x0.5", "x2"))
    assert [score.value for score in first.scores] == pytest.approx([0.41, 0.71])
    assert first.usual.value == pytest.approx(0.81)
    assert first.spread == pytest.approx(0.4)
    assert second.parameter == "closing_px"


def test_only_what_all_have_is_compared():
    made = [*outcomes({"rgb": [0.8, 0.9], "rgb:a=1": [0.5, 0.5]}), *outcomes({"rgb:a=2": [0.5]})]
    (found,) = sensitivities(made, "success_auc")
    assert found.usual.value == pytest.approx(0.8)  # seed 1 has no figure for a = 2
