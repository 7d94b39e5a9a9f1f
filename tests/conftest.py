"""Settings of the whole suite: shapes in annotations are checked, and chance is the same every time in CI."""

import os
from collections.abc import Callable
from typing import Any

import beartype
import numpy as np
from beartype.roar import BeartypeDecorHintPep673Exception
from hypothesis import settings
from jaxtyping import install_import_hook

import vision_robot.types

CHECKED = [
    "vision_robot.geometry",
    "vision_robot.formats",
    "vision_robot.calibrate",
    "vision_robot.extrinsics",
    "vision_robot.dataset",
    "vision_robot.sim",
    "vision_robot.track",
]

# Annotations mean what they say, except that an int may stand where a float is asked for (PEP 484).
strict = beartype.beartype(conf=beartype.BeartypeConf(is_pep484_tower=True))


def checked_in_tests(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function with its annotations checked at every call; left alone where it mentions `Self`.

    jaxtyping hands over single methods, and beartype knows `Self` only inside whole classes.
    """
    try:
        return strict(function)
    except BeartypeDecorHintPep673Exception:
        return function


# Where an array of no dimensions is meant numpy gives one of its scalars.
vision_robot.types.Array = np.ndarray | np.generic  # type: ignore[assignment,misc]
# The hook takes its checker by a dotted name, and this file cannot be imported by one.
beartype.checked_in_tests = checked_in_tests  # type: ignore[attr-defined]
install_import_hook(CHECKED, "beartype.checked_in_tests")

# No deadline: shared machines pause. CI must not fail by chance; a person's run may find more.
settings.register_profile("person", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "person")
