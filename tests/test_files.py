"""Proves that an output is either whole or as it was, whatever happens while it is written."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from vision_robot.errors import UnwritableOutput
from vision_robot.files import atomic_path, write_bytes, write_text


def test_what_is_written_is_read(tmp_path):
    write_text(tmp_path / "new folder/camera.yaml", "fx: 1000 ± 1\n")
    assert (tmp_path / "new folder/camera.yaml").read_text(encoding="utf-8") == "fx: 1000 ± 1\n"
    assert [path.name for path in (tmp_path / "new folder").iterdir()] == ["camera.yaml"]


def test_the_temporary_file_has_the_suffix_that_writers_go_by(tmp_path):
    with atomic_path(tmp_path / "report.html") as temporary:
        assert temporary.suffix == ".html"
        assert temporary.parent == tmp_path


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_an_error_leaves_the_old_file(tmp_path, error):
    target = tmp_path / "camera.yaml"
    target.write_text("old")

    def fail():
        with atomic_path(target) as temporary:
            temporary.write_text("half")
            raise error

    with pytest.raises(error):
        fail()
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["camera.yaml"]


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="there is no SIGKILL on this system")
def test_a_kill_leaves_the_old_file(tmp_path):
    target = tmp_path / "camera.yaml"
    target.write_text("old")
    script = (
        "import os, signal, sys\n"
        "from vision_robot.files import atomic_path\n"
        "with atomic_path(sys.argv[1]) as temporary:\n"
        "    temporary.write_text('half')\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    ended = subprocess.run([sys.executable, "-c", script, str(target)], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert target.read_text() == "old"


def test_permissions_are_those_of_an_ordinary_file(tmp_path):
    mask = os.umask(0o027)
    try:
        write_bytes(tmp_path / "a", b"")
    finally:
        os.umask(mask)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("place", ["", "file/below", "n" * 300])
def test_a_place_that_cannot_be_written_is_refused(tmp_path, place):
    (tmp_path / "file").write_text("")
    with pytest.raises(UnwritableOutput) as caught:
        write_text(tmp_path / place, "x")
    assert caught.value.path in str(caught.value)
    assert sorted(path.name for path in Path(tmp_path).iterdir()) == ["file"]
