"""Proves that bash, zsh and fish are told what may follow, by the protocol their scripts speak."""

import os
import shutil
import subprocess
import sys

import pytest

from vision_robot_cli.commands import COMMANDS, IK

VR = [sys.executable, "-c", "from vision_robot_cli.main import main; main()"]
SHELLS = ("bash", "zsh", "fish")


def asked(shell: str, line: str) -> str:
    """What the shell is answered when Tab is pressed at the end of the line."""
    words = line.split(" ")
    told = {
        "bash": {"COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1)},
        "zsh": {"_TYPER_COMPLETE_ARGS": line},
        "fish": {"_TYPER_COMPLETE_ARGS": line, "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
    }[shell]
    environment = {**os.environ, **told, "_VR_COMPLETE": f"complete_{shell}"}
    ended = subprocess.run(VR, capture_output=True, text=True, env=environment, check=True, timeout=60)
    assert ended.stderr == ""
    return ended.stdout


def offered(line: str) -> list[str]:
    return asked("bash", line).split()


def test_commands_groups_and_options():
    assert offered("vr ") == list(COMMANDS)
    assert offered("vr cal") == ["calibrate"]
    assert offered("vr ik ") == list(IK)
    assert offered("vr calibrate --mod") == ["--model", "--model-points"]


@pytest.mark.parametrize(
    ("line", "first"),
    [
        ("vr calibrate --board a", ["acircles", "aprilgrid"]),
        ("vr calibrate --model p", ["pinhole"]),
        ("vr calibrate --format m", ["mrcal", "matlab"]),
        ("vr track video f.mp4 --tracker rgb", ["rgb", "rgb-plain"]),
        ("vr synth mo", ["motion-blur"]),
        ("vr schema ik.s", ["ik.solve", "ik.stream"]),
        ("vr ik check c", ["column"]),
    ],
)
def test_names_come_from_the_registries(line, first):
    assert offered(line) == first


@pytest.mark.parametrize("shell", SHELLS)
def test_every_shell_is_answered_in_its_own_way(shell):
    said = asked(shell, "vr extrinsics ha")
    assert "hand-eye" in said
    assert ("camera" in said) == (shell != "bash")  # zsh and fish show a line of help beside each name
    assert said.startswith("_arguments") == (shell == "zsh")


def shell_script(shell: str, option: str, home) -> str:
    told = {"HOME": str(home), "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    return subprocess.run(
        [*VR, option, shell],
        capture_output=True,
        text=True,
        env={**os.environ, **told},
        check=True,
        timeout=60,
    ).stdout


@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_can_be_shown_and_installed(shell, tmp_path):
    assert f"_VR_COMPLETE=complete_{shell}" in shell_script(shell, "--show-completion", tmp_path)
    shell_script(shell, "--install-completion", tmp_path)
    written = [path for path in tmp_path.rglob("*") if path.is_file() and "complete_" in path.read_text()]
    assert len(written) == 1


@pytest.mark.skipif(not shutil.which("bash"), reason="needs bash")
def test_bash_itself_completes(tmp_path):
    """The script in a real bash, with a `vr` on its path."""
    program = tmp_path / "vr"
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m vision_robot_cli.main "$@"\n')
    program.chmod(0o755)
    (tmp_path / "completion.sh").write_text(shell_script("bash", "--show-completion", tmp_path))
    lines = [
        "source ./completion.sh",
        "COMP_WORDS=(vr undi)",
        "COMP_CWORD=1",
        "_vr_completion ./vr",
        'echo "${COMPREPLY[@]}"',
    ]
    asked = ["bash", "-c", "; ".join(lines)]
    ended = subprocess.run(asked, capture_output=True, text=True, cwd=tmp_path, check=True, timeout=60)
    assert ended.stdout == "undistort\n"
