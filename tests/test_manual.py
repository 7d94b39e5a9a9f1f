"""Proves what can be proved of the manual without building it: its commands, code, pictures and words.

That it builds without a warning and fetches nothing from a network is shown by `.ci/run`.
"""

import ast
import re
import shlex
from pathlib import Path

import pytest
import yaml

from tests.cli.parsing import parse
from tests.track.scenes import moving, rendered
from vision_robot.track.session import track
from vision_robot_cli.commands import every_command

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
GENERATED = ("commands", "json", "tables")
PAGES = [path for path in sorted(DOCS.rglob("*.md")) if path.parent.name not in GENERATED]
BLOCK = re.compile(r"^ *```(\w+)\n(.*?)^ *```", re.MULTILINE | re.DOTALL)

# Hosts of packages and places on a machine have no business in a manual.
FORBIDDEN = re.compile(r"/(?:work|tmp|home|root)/|https?://\S+\.(?:whl|tar\.gz|zip)|raw\.githubusercontent")


def blocks(language: str) -> list[tuple[str, str]]:
    return [
        (str(path.relative_to(ROOT)), body)
        for path in [*PAGES, ROOT / "README.md"]
        for found, body in BLOCK.findall(path.read_text(encoding="utf-8"))
        if found == language
    ]


def commands() -> list[tuple[str, str]]:
    """Every command line of `vr` in the manual; comments and redirections are the shell's."""
    lines = []
    for place, body in blocks("sh"):
        for line in body.splitlines():
            words = line.split("#")[0].partition(" > ")[0].strip()
            if words.startswith(("vr ", "./vr ")) and words != "./vr test":
                lines.append((place, words))
    return lines


@pytest.mark.parametrize(("place", "line"), commands())
def test_every_command_line_is_right(place, line):
    parse(shlex.split(line)[1:])


def test_there_is_something_to_test():
    assert len(commands()) > 40
    assert len({line.split()[1] for _, line in commands()}) >= 10
    with pytest.raises(Exception, match="--bogus"):
        parse(["board", "--bogus"])


@pytest.mark.parametrize(("place", "body"), blocks("python"))
def test_code_parses_and_its_imports_are_there(place, body):
    tree = ast.parse(body)
    imports: list[ast.stmt] = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    exec(compile(ast.Module(imports, []), place, "exec"), {})


def test_the_tracker_of_the_guide_tracks():
    (code,) = (body for place, body in blocks("python") if place.endswith("own_tracker.md"))
    made: dict = {"__name__": "guide"}
    exec(compile(code, "own_tracker.md", "exec"), made)
    frames = [255 - frame for frame in rendered(moving, 20)]
    tracks = track(frames, made["Darkest"](made["DarkestOptions"](threshold=200)))
    assert len(set(tracks.id.tolist())) >= 1


def test_the_example_workflow_holds_a_benchmark_against_its_baseline():
    workflow = yaml.safe_load((DOCS / "examples/vision-benchmark.yml").read_text())
    steps = [step["run"] for step in workflow["jobs"]["benchmark"]["steps"] if "run" in step]
    (benchmark,) = (run for run in steps if "vr benchmark" in run)
    assert "--baseline baseline.json" in benchmark
    parse(shlex.split(benchmark.partition(" > ")[0])[1:])


def test_pictures_are_all_used_and_small():
    named = {name for path in PAGES for name in re.findall(r"pictures/([\w.]+)", path.read_text())}
    there = {path.name: path.stat().st_size for path in (DOCS / "pictures").iterdir()}
    assert named == set(there)
    assert sum(there.values()) < 2e6


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(DOCS)))
def test_no_page_names_a_host_of_packages_or_a_place_on_a_machine(path):
    assert not FORBIDDEN.search(path.read_text(encoding="utf-8"))


def test_every_command_gets_a_page():
    """The pages themselves are made by the extension from the same list."""
    text = (DOCS / "extension/commands.py").read_text()
    assert "every_command()" in text
    assert len(list(every_command())) >= 20
