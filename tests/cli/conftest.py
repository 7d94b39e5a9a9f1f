"""Every object that a command prints with `--json` in these tests is held against its published schema."""

import pytest

from tests.cli.json_schemas import faults
from vision_robot_cli import output


@pytest.fixture(autouse=True)
def outputs_keep_their_schemas(monkeypatch):
    emit = output.emit_json

    def checked(command, result, *, version=1):
        assert not faults({"schema": f"vr.{command}/{version}", **output.plain(result)})
        emit(command, result, version=version)

    monkeypatch.setattr(output, "emit_json", checked)
