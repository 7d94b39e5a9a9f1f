"""Proves that the examples of every command's help are right: all can be parsed, the quick ones are run.

Those that are run are run with `--json` too, and what they print is held against its schema.
"""

import json
import shlex
import shutil
from pathlib import Path

import pytest

from tests.cli.json_schemas import faults
from tests.cli.parsing import parse
from tests.cli.workshop import furnish
from vision_robot_cli.commands import every_command
from vision_robot_cli.examples import examples_in, with_examples_whole
from vision_robot_cli.main import load, run

EXAMPLES = [
    (words, example)
    for words, command in every_command()
    for example in examples_in(load(command.target).__doc__ or "")
]

# What they need that is not here: a device, a bag, minutes. Other tests run these commands.
ONLY_PARSED = {
    "vr benchmark calibration --seeds 5 --workers 2 --report calibration.html",
    "vr calibrate run.mcap --topic /camera/image_raw --size 9x6 --square 25mm -o camera.yaml",
    "vr demo -o demo",
    "vr extrinsics hand-eye photos/*.jpg --poses poses.csv --camera camera.json -o hand_eye.json",
    "vr extrinsics rig left/ right/ top/ --size 9x6 --square 25mm -o rig.json",
    "vr extrinsics tool left/ right/ --poses poses.csv --camera left.json --camera right.json",
    "vr ik stream goals.csv --poses --port COM3",
    "vr ik stream moves.csv --port /dev/ttyACM0 --rate 0.5",
    "vr pick --episodes 20 --loop look-move-look --fault camera-rotation=0.5deg",
    "vr synth single-rod -o rod --frames 120 --workers 2 --preview",
    "vr track camera 0 --tracker rgb --color red --plane plane.json -o tracks.csv",
    "vr track video run.mcap --topic /camera/image_raw -o tracks.csv",
}
SAYS_JSON_ANYWAY = ("vr schema calibrate",)
QUICK = [example for _, example in EXAMPLES if example not in ONLY_PARSED]


@pytest.fixture(scope="module")
def workshop(tmp_path_factory):
    folder = tmp_path_factory.mktemp("workshop")
    furnish(folder)
    return folder


@pytest.mark.parametrize(("words", "command"), [*every_command()])
def test_every_command_has_an_example(words, command):
    examples = examples_in(load(command.target).__doc__ or "")
    assert examples, f"write a line 'Example: vr {' '.join(words)} ...' into the docstring"
    assert all(example.startswith(" ".join(["vr", *words])) for example in examples)


@pytest.mark.parametrize("example", [example for _, example in EXAMPLES])
def test_every_example_can_be_parsed(example):
    parse(shlex.split(example)[1:])


def test_what_is_no_option_is_not_parsed():
    with pytest.raises(Exception, match="--modle"):
        parse(["calibrate", "--modle", "pinhole"])


@pytest.mark.parametrize("example", QUICK)
def test_quick_examples_run_and_print_what_their_schema_says(
    workshop, tmp_path, monkeypatch, capsys, example
):
    monkeypatch.chdir(shutil.copytree(workshop, tmp_path / "workshop"))
    words = [found for word in shlex.split(example)[1:] for found in expanded(word)]
    as_json = [] if "--json" in words or example in SAYS_JSON_ANYWAY else ["--json"]
    assert run([*words, *as_json]) == 0
    result = json.loads(capsys.readouterr().out)
    if example not in SAYS_JSON_ANYWAY:
        assert faults(result) == []


def expanded(word: str) -> list[str]:
    """As the shell does."""
    return sorted(str(path) for path in Path().glob(word)) if "*" in word else [word]


def test_only_real_examples_are_left_out():
    assert {example for _, example in EXAMPLES} >= ONLY_PARSED


def test_examples_are_not_wrapped_in_the_help(capsys):
    assert run(["calibrate", "--help"]) == 0
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    for example in examples_in(load("vision_robot_cli.calibrate:calibrate").__doc__ or ""):
        assert f"Example: {example}" in lines


def test_examples_are_told_from_other_text():
    text = "One line.\n\n    More, as an Example: vr board.\n\n    Example: vr board\n    Example: vr demo"
    assert examples_in(text) == ["vr board", "vr demo"]
    assert with_examples_whole(text).count("\b") == 2
