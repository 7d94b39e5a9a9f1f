"""Quantities as people type them."""

import pytest

from vision_robot.errors import BadParameter
from vision_robot_cli.quantities import length_m, whole_pair


@pytest.mark.parametrize(
    ("text", "metres"),
    [("25mm", 0.025), ("2.5cm", 0.025), ("0.025m", 0.025), ("1in", 0.0254), ('1"', 0.0254),
     (" 25 MM ", 0.025), ("250um", 2.5e-4), ("250µm", 2.5e-4), ("2.5e1mm", 0.025), ("+3m", 3)],
)  # fmt: skip
def test_lengths(text, metres):
    """Units of every day; exactly, not to the last bit but one."""
    assert length_m(text, "--square") == metres


@pytest.mark.parametrize(
    "text", ["25", "0.025", "mm", "", "0mm", "-1mm", "25furlong", "1.2.3mm", "nan mm", "9e99m"]
)
def test_lengths_that_are_none(text):
    """Above all: no number without its unit."""
    with pytest.raises(BadParameter, match=r"--square is .* such as 25mm"):
        length_m(text, "--square")


@pytest.mark.parametrize("text", ["9x6", "9X6", "9 x 6", "9×6", "9,6", "9*6"])
def test_pairs(text):
    """Across, then down."""
    assert whole_pair(text, "--size") == (9, 6)


@pytest.mark.parametrize("text", ["9", "9x", "x6", "9x6x3", "0x6", "-9x6", "9.5x6", "axb", ""])
def test_pairs_that_are_none(text):
    """Two whole numbers above zero, or none."""
    with pytest.raises(BadParameter, match="--size"):
        whole_pair(text, "--size")
