"""Numbers with no more digits than are known."""

import pytest

from vision_robot.report.quantity import compact, listed, with_sigma


@pytest.mark.parametrize(
    ("value", "sigma", "expected"),
    [
        (1000.7533, 0.4321, ("1000.75", "0.43")),
        (1000.7533, 4.321, ("1000.8", "4.3")),
        (1000.7533, 43.21, ("1001", "43")),
        (-0.00049, 0.00011, ("−0.00049", "0.00011")),
        (12.3456, 0.0996, ("12.35", "0.10")),
        (12.3456, 0.9996, ("12.3", "1.0")),
        (-0.0001, 0.5, ("0.00", "0.50")),
        (0.0, 0.0, ("0", "–")),
        (5.25, float("nan"), ("5.25", "–")),
    ],
)
def test_two_digits_of_sigma_decide(value, sigma, expected):
    assert with_sigma(value, sigma) == expected


@pytest.mark.parametrize(
    ("value", "digits", "expected"),
    [
        (0.28945, 3, "0.289"),
        (1234.5, 3, "1234"),
        (0.0996, 2, "0.10"),
        (9.99, 2, "10"),
        (-2.5, 2, "−2.5"),
        (0.0, 3, "0"),
        (1.2e-9, 2, "1.2e−09"),
        (float("nan"), 3, "–"),
    ],
)
def test_so_many_digits(value, digits, expected):
    assert compact(value, digits) == expected


def test_names_as_a_sentence_lists_them():
    assert listed(["a"]) == "a"
    assert listed(["a", "b"]) == "a and b"
    assert listed(["a", "b", "c"]) == "a, b and c"
    assert listed(list("abcdefgh"), 4) == "a, b, c and 5 more"
