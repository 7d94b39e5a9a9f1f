"""Proves that `./vr` sets up once, resumes, passes everything through, and says each failure in one line.

uv and the environment's Python are played by small shell scripts, so nothing is downloaded: what
the real ones do is shown by `.ci/run`.
"""

import importlib.machinery
import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
pytestmark = pytest.mark.skipif(os.name == "nt", reason="the stand-ins are shell scripts")

# Writes down what it is asked, makes the environment's Python, and fails or dawdles when told to.
UV = """#!/bin/sh
echo "$*" >> "$CALLS"
case "$1" in
venv)
    for last; do :; done
    mkdir -p "$last/bin"
    echo "version = 3.11" > "$last/pyvenv.cfg"
    cp "$PYTHON_STANDIN" "$last/bin/python"
    ;;
pip)
    [ -z "$DAWDLE" ] || { touch "$CALLS.started"; sleep "$DAWDLE"; }
    if [ -n "$BROKEN" ]; then
        printf 'error: Failed to fetch\\n  cause: dns error\\n' >&2
        exit 2
    fi
    ;;
esac
"""
# Is asked whether OpenGL works (-P -c ...), or is the program itself (-P -m module arguments).
PYTHON = """#!/bin/sh
[ "$2" = -c ] && exit ${NO_OPENGL:-0}
shift 2
for word; do echo "<$word>"; done
exit 7
"""


@pytest.fixture
def launcher():
    """The launcher as a module."""
    loader = importlib.machinery.SourceFileLoader("launcher", str(ROOT / "vr"))
    spec = importlib.util.spec_from_loader("launcher", loader)
    assert spec
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


class Clone:
    """A clone in a folder with a space in its name, on a machine with a stand-in for uv."""

    def __init__(self, folder: Path):
        self.root = folder / "a clone"
        self.root.mkdir()
        self.calls_file = folder / "calls"
        for name in ("vr", "pyproject.toml", "requirements.txt", "requirements-test.txt"):
            shutil.copy(ROOT / name, self.root / name)
        bin_folder = folder / "bin"
        bin_folder.mkdir()
        for path, text in ((bin_folder / "uv", UV), (folder / "python", PYTHON)):
            path.write_text(text)
            path.chmod(0o755)
        self.environment = {
            "PATH": f"{bin_folder}{os.pathsep}/usr/bin{os.pathsep}/bin",
            "CALLS": str(self.calls_file),
            "PYTHON_STANDIN": str(folder / "python"),
        }

    def start(self, *arguments: str, **environment: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, str(self.root / "vr"), *arguments],
            env={**self.environment, **environment},
            cwd="/",
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def run(self, *arguments: str, **environment: str) -> tuple[int, str, str]:
        process = self.start(*arguments, **environment)
        out, err = process.communicate(timeout=60)
        return process.returncode, out, err

    @property
    def calls(self) -> list[str]:
        return self.calls_file.read_text().splitlines() if self.calls_file.exists() else []


@pytest.fixture
def clone(tmp_path):
    return Clone(tmp_path)


def test_it_installs_the_pins_then_the_project_and_becomes_the_command(clone):
    code, out, err = clone.run("calibrate", "my photos/*.jpg", "--json")
    assert code == 7
    assert out == "<vision_robot_cli>\n<calibrate>\n<my photos/*.jpg>\n<--json>\n"
    venv, pins, project = clone.calls
    assert venv.startswith("venv")
    assert f"-r {clone.root}/requirements.txt" in pins
    assert project.endswith(f"--no-deps -e {clone.root}")
    assert all(line.startswith("vr: ") for line in err.splitlines())


def test_the_second_run_only_becomes_the_command(clone):
    clone.run("demo")
    before = clone.calls
    code, out, err = clone.run("demo")
    assert (code, err) == (7, "")
    assert out.endswith("<demo>\n")
    assert clone.calls == before


def test_tests_need_more_and_then_run_pytest(clone):
    clone.run("demo")
    code, out, _ = clone.run("test", "-k", "two words")
    assert code == 7
    assert out == "<pytest>\n<-n>\n<2>\n<-k>\n<two words>\n"
    assert "requirements-test.txt" in clone.calls[-2]
    before = clone.calls
    clone.run("demo")
    assert clone.calls == before, "what the tests added must not undo the first set-up"


def test_a_debugger_gets_one_process(launcher):
    assert launcher.plan(["test", "--pdb"])[1][-2:] == ["pytest", "--pdb"]
    assert launcher.plan(["test", "tests/cli"])[1][-4:] == ["pytest", "-n", "2", "tests/cli"]


@pytest.mark.parametrize("name", ["requirements.txt", "pyproject.toml"])
def test_changed_pins_or_metadata_are_installed(clone, name):
    clone.run("demo")
    before = len(clone.calls)
    (clone.root / name).write_text((clone.root / name).read_text() + "# changed\n")
    clone.run("demo")
    assert [call.split()[0] for call in clone.calls[before:]] == ["pip", "pip"]


def test_a_moved_clone_is_installed_again(clone):
    clone.run("demo")
    before = len(clone.calls)
    moved = clone.root.with_name("elsewhere")
    clone.root.rename(moved)
    clone.root = moved
    clone.run("demo")
    assert any(call.endswith(f"-e {moved}") for call in clone.calls[before:])


def test_without_any_opengl_the_wheel_is_installed(clone):
    clone.run("demo", NO_OPENGL="1")
    assert clone.calls[-1].split()[-2:] == ["--no-deps", "lavavu-osmesa==1.9.10"]


def test_no_network_is_one_line_and_the_next_run_goes_on(clone):
    code, out, err = clone.run("demo", BROKEN="1")
    assert (code, out) == (1, "")
    last = err.splitlines()[-1]
    assert last.startswith("vr: error: the packages cannot be installed (cause: dns error; all of it in ")
    assert "network" in last
    assert "Traceback" not in err
    assert clone.run("demo")[0] == 7


def test_a_killed_set_up_goes_on(clone):
    process = clone.start("demo", DAWDLE="20")
    wait_for(clone.calls_file.with_name("calls.started"))
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    assert not (clone.root / ".venv/vr-setup.json").exists()
    assert clone.run("demo")[0] == 7


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interrupted_set_up_ends_at_once_with_its_code(clone, number, code):
    process = clone.start("demo", DAWDLE="20")
    wait_for(clone.calls_file.with_name("calls.started"))
    os.kill(process.pid, number)
    _, err = process.communicate(timeout=10)
    assert process.returncode == code
    assert "Traceback" not in err
    os.killpg(process.pid, signal.SIGKILL)  # the stand-in's sleep


def test_two_launches_at_once_set_up_once(clone):
    first = clone.start("demo", DAWDLE="1")
    wait_for(clone.calls_file.with_name("calls.started"))
    second = clone.start("demo", DAWDLE="1")
    errors = [process.communicate(timeout=60)[1] for process in (first, second)]
    assert (first.returncode, second.returncode) == (7, 7)
    assert [call.split()[0] for call in clone.calls] == ["venv", "pip", "pip"]
    assert "waiting for another set-up" in errors[1]


def test_a_half_written_or_foreign_stamp_means_not_ready(clone):
    clone.run("demo")
    before = len(clone.calls)
    (clone.root / ".venv/vr-setup.json").write_text('{"run": ')
    assert clone.run("demo")[0] == 7
    assert len(clone.calls) > before


def test_python_without_venv_names_the_debian_package(launcher, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(launcher, "VENV", tmp_path / ".venv")
    monkeypatch.setattr(launcher, "PYTHON", tmp_path / ".venv/bin/python")
    monkeypatch.setattr(launcher.shutil, "which", lambda name: None)
    monkeypatch.setattr(launcher, "has_module", lambda name: name != "ensurepip")
    assert launcher.main(["demo"]) == 2
    assert "apt-get install python3-venv" in capsys.readouterr().err


def test_an_old_python_gives_way_to_a_newer_one(launcher, monkeypatch):
    became = []
    monkeypatch.setattr(launcher.sys, "version_info", (3, 9, 2))
    monkeypatch.setattr(launcher.shutil, "which", lambda name: "/bin/p12" if name == "python3.12" else None)
    monkeypatch.setattr(launcher, "become", became.append)
    with pytest.raises(launcher.SetupFailed):  # `become` does not return outside this test
        launcher.need_python()
    assert became[0][0] == "/bin/p12"


def test_an_old_python_alone_is_told_so(launcher, monkeypatch, capsys):
    monkeypatch.setattr(launcher.sys, "version_info", (3, 9, 2))
    monkeypatch.setattr(launcher.shutil, "which", lambda name: None)
    assert launcher.main(["demo"]) == 2
    assert capsys.readouterr().err == "vr: error: Python 3.9 is too old: install Python 3.11 or newer\n"


@pytest.mark.parametrize("name", ["requirements.txt", "requirements-test.txt", "requirements-lint.txt"])
def test_pins_hold_versions_and_nothing_of_a_machine(name):
    for line in (ROOT / name).read_text().splitlines():
        requirement = line.split(";")[0].strip()
        package, _, version = requirement.partition("==")
        assert package, line
        assert version, line
        assert not line.startswith("-"), line
        assert not set("/@\\") & set(line), line


def wait_for(path: Path) -> None:
    for _ in range(500):
        if path.exists():
            return
        time.sleep(0.02)
    raise AssertionError(f"{path} did not appear")
