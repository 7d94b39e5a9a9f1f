"""Arms exported every way and compiled once for all tests."""

import pytest

from tests.arm.arms import UR5E
from tests.arm.compiled import CompiledArm, arm_of, column_arm


@pytest.fixture(scope="session")
def compiled(tmp_path_factory):
    """A function that gives the compiled arm for a method and precision."""
    arms = {"column": column_arm(), "ur5e": arm_of(UR5E)}
    made = {}

    def of(method: str, precision: str, arm: str = "column") -> CompiledArm:
        key = (arm, method, precision)
        if key not in made:
            folder = tmp_path_factory.mktemp("-".join(key))
            made[key] = CompiledArm(arms[arm], folder, method=method, precision=precision)
        return made[key]

    return of
