"""The column arm as C with its receiver, compiled once."""

import pytest

from tests.arm.compiled import CompiledArm, column_arm


@pytest.fixture(scope="session")
def arm_in_c(tmp_path_factory):
    return CompiledArm(column_arm(), tmp_path_factory.mktemp("receiver"), precision="single")
