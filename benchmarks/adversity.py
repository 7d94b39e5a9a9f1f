"""What commands do where disks are full, folders read-only, names odd, clocks wrong, outputs closed.

Each condition is tried with commands that read and write files. A command must either do its work, its files
being as they always are, or end with 1 or 2 and one line that says why, nothing half-written at its place.
Some conditions need root or a tool (mount, unshare, faketime, a German locale); where that is missing
they are left out, and the table says so.
"""

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path

from long_commands import COMMANDS, Ended, LongCommand, contents, material, run, start, whole
from table import markdown, shown

TRIED = ("ik export", "undistort", "calibrate", "track video", "extrinsics plane", "synth", "benchmark")
QUICK = ("ik export",)

Do = Callable[[LongCommand, Path, Path], "Iterator[tuple[Ended, Path]]"]
"""Runs a command on material, given a folder to work in; gives each end, and where its outputs are."""


@dataclass(frozen=True)
class Condition:
    """One kind of adversity."""

    name: str
    do: Do
    needs: str = ""
    """A program or `root`."""
    must_work: bool = True
    """Whether the command must do its work in spite of it."""


@dataclass
class Tally:
    """What came of one condition."""

    condition: str
    runs: int = 0
    done: int = 0
    refused: int = 0
    wrong: int = 0
    left_out: str = ""
    first_wrong: str = ""
    example: str = ""
    """A line with which a command refused."""
    commands: list[str] = field(default_factory=list)


def main() -> None:
    """Print the table."""
    asked = arguments()
    conditions = [one for one in CONDITIONS if not asked.only or any(only in one.name for only in asked.only)]
    names = [name for name in TRIED if not asked.command or name in asked.command]
    with tempfile.TemporaryDirectory(prefix="vr adversity ") as place:
        given = Path(place) / "in"
        material(given)
        right = {}
        for name in names:
            out = Path(place) / name
            out.mkdir()
            ended = run(COMMANDS[name].command(given, out))
            if ended.code:
                sys.exit(f"{name} fails without any adversity: {ended.err}")
            right[name] = contents(out)
        tallies = [tried(one, names, given, Path(place) / "try", right) for one in conditions]
    print(shown("vr.benchmark.adversity/1", [asdict(t) for t in tallies], table(tallies), as_json=asked.json))


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", action="append", help="Only conditions whose names hold this.")
    parser.add_argument("--command", action="append", help="Only this command.")
    parser.add_argument("--quick", action="store_true", help="Only show that it runs.")
    parser.add_argument("--json", action="store_true")
    asked = parser.parse_args()
    if asked.quick:
        asked.command, asked.only = list(QUICK), ["spaces", "stdout on a full"]
    return asked


def tried(
    condition: Condition, names: list[str], given: Path, place: Path, right: Mapping[str, dict[str, str]]
) -> Tally:
    """All commands under one condition."""
    tally = Tally(condition.name)
    if condition.needs and not available(condition.needs):
        tally.left_out = f"needs {condition.needs}"
        return tally
    for name in names:
        command = COMMANDS[name]
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        for ended, out in condition.do(command, given, place):
            judge(tally, condition, command, ended, out, right[name])
        tally.commands.append(name)
    print(f"{condition.name}: {tally.first_wrong or 'all well'}", file=sys.stderr, flush=True)
    return tally


def judge(
    tally: Tally,
    condition: Condition,
    command: LongCommand,
    ended: Ended,
    out: Path,
    right: Mapping[str, str],
) -> None:
    """Count one end."""
    tally.runs += 1
    wrong = whole(command, out, right) if out.is_dir() else [f"{name} is missing" for name in right]
    if not ended.is_clean:
        wrong = [f"ended with {ended.code}: {ended.err.strip()[-300:]!r}"]
    elif ended.code:
        # What is missing is missing; nothing else may be left.
        wrong = [
            text for text in wrong if not text.endswith("is missing") and "/." not in text and text[0] != "."
        ]
        if condition.must_work:
            wrong.append(f"ended with {ended.code}: {ended.err.strip()}")
        tally.example = tally.example or ended.err.strip().splitlines()[-1]
    tally.done += ended.code == 0 and not wrong
    tally.refused += ended.code != 0 and not wrong
    if wrong:
        tally.wrong += 1
        tally.first_wrong = tally.first_wrong or f"{command.name}: {wrong[0]}"


def available(needs: str) -> bool:
    """Whether it is here."""
    if needs == "root":
        return os.geteuid() == 0 and shutil.which("mount") is not None
    if needs == "de_DE":
        return (
            "de_DE.utf8"
            in subprocess.run(["locale", "-a"], capture_output=True, text=True, check=False).stdout
        )
    return shutil.which(needs) is not None


@contextmanager
def mounted(place: Path, options: str) -> Iterator[Path]:
    """A file system in memory."""
    place.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(place)], check=True)
    try:
        yield place
    finally:
        subprocess.run(["umount", "-l", str(place)], check=True)


# Places.


def full_disk(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
    """A disk with room for a little of the output, and one without any."""
    for size in ("4k", "24k", "200k"):
        with mounted(place / size, f"size={size}") as disk:
            ended = run(command.command(given, disk))
            if ended.code:  # where it had room enough it is no matter of full disks
                yield ended, disk


def largest_file(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
    """A quota on the size of files."""
    out = place / "out"
    out.mkdir()

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (900, 900))

    yield run(command.command(given, out), preexec_fn=limit), out


def read_only(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
    """A folder that cannot be written to."""
    with mounted(place / "disk", "ro") as disk:
        yield run(command.command(given, disk)), disk


def file_in_the_way(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
    """A file where the folder of outputs is to be."""
    (place / "out").write_text("")
    yield run(command.command(given, place / "out")), place / "out"


def twice(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
    """Two runs into one folder at the same time, then a third."""
    out = place / "out"
    out.mkdir()
    both = [start(command.command(given, out)) for _ in range(2)]
    told = [process.communicate(timeout=600) for process in both]
    ended = [Ended(one.returncode, *texts, 0.0) for one, texts in zip(both, told, strict=True)]
    # One of them may find that the other was faster, and say so; the files must be right in any case.
    if all(one.is_clean for one in ended) and any(one.code == 0 for one in ended):
        yield Ended(0, "", "", 0.0), out
    else:
        yield next(one for one in ended if not one.is_clean or one.code), out
    yield run(command.command(given, out)), out


NAMES = (
    "with spaces",
    "Öl & größe",
    "日本語",
    'it\'s "quoted"; $(touch pwned)',
    "-rf",
    "a%04d{:d}%s",
    "new\nline",
)


def odd_names(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
    """Folders whose names are unusual."""
    for name in NAMES:
        (place / name).mkdir()
        shutil.copytree(given, place / name / "in")
        (place / name / "out").mkdir()
        yield run(command.command(place / name / "in", place / name / "out")), place / name / "out"


def bytes_for_names(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
    """Folders and pictures whose names are no text in UTF-8."""
    odd = Path(os.fsdecode(os.fsencode(place) + b"/caf\xe9"))
    odd.mkdir()
    shutil.copytree(given, odd / "in")
    (odd / "out").mkdir()
    yield run(command.command(odd / "in", odd / "out")), odd / "out"


# Surroundings.


def surroundings(**changes: str | None) -> Do:
    """Environment variables set, or taken away."""

    def do(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
        out = place / "out"
        out.mkdir()
        environment = {name: value for name, value in os.environ.items() if name not in changes}
        environment |= {name: value for name, value in changes.items() if value is not None}
        yield run(command.command(given, out), env=environment), out

    return do


def before(*words: str) -> Do:
    """Another program that starts the command."""

    def do(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
        out = place / "out"
        out.mkdir()
        yield run([*words, *command.command(given, out)]), out

    return do


def clock_back(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
    """A run whose clock jumps back by a day under way, and one more two years earlier."""
    out, stamp = place / "out", place / "stamp"
    out.mkdir()
    stamp.write_text("+0")
    environment = {
        **os.environ,
        "FAKETIME_TIMESTAMP_FILE": str(stamp),
        "FAKETIME_NO_CACHE": "1",
        "FAKETIME_DONT_FAKE_MONOTONIC": "1",
        "DONT_FAKE_MONOTONIC": "1",
    }
    library = next(Path("/usr/lib").rglob("libfaketimeMT.so.1"), None) or next(
        Path("/usr/lib").rglob("libfaketime.so.1")
    )
    process = start(command.command(given, out), env={**environment, "LD_PRELOAD": str(library)})
    time.sleep(1.0)
    stamp.write_text("-1d")
    texts = process.communicate(timeout=600)
    yield Ended(process.returncode, *texts, 0.0), out
    stamp.write_text("-730d")
    yield run(command.command(given, out), env={**environment, "LD_PRELOAD": str(library)}), out


# Standard streams.


def shell(text: str) -> Do:
    """The command inside a line of a shell, as "$@"; its end is that of the command itself."""

    def do(command: LongCommand, given: Path, place: Path) -> Iterator[tuple[Ended, Path]]:
        out = place / "out"
        out.mkdir()
        yield run(["bash", "-c", f"set -o pipefail; {text}", "bash", *command.command(given, out)]), out

    return do


CONDITIONS = (
    Condition("disk full", full_disk, needs="root", must_work=False),
    Condition("files limited to 900 bytes", largest_file, must_work=False),
    Condition("read-only folder", read_only, needs="root", must_work=False),
    Condition("a file where the folder is to be", file_in_the_way, must_work=False),
    Condition("two runs into one folder", twice),
    Condition("spaces, other scripts, quotes, newline in paths", odd_names),
    Condition("names that are no UTF-8", bytes_for_names, must_work=False),
    Condition("no HOME", surroundings(HOME=None, XDG_CACHE_HOME=None)),
    Condition("HOME is not there", surroundings(HOME="/nonexistent/home", XDG_CACHE_HOME=None)),
    Condition(
        "locale with decimal comma", surroundings(LC_ALL="de_DE.UTF-8", LANG="de_DE.UTF-8"), needs="de_DE"
    ),
    Condition(
        "plain C locale without UTF-8", surroundings(LC_ALL="C", PYTHONUTF8="0", PYTHONCOERCECLOCALE="0")
    ),
    Condition("temporary folder is not there", surroundings(TMPDIR="/nonexistent/tmp")),
    Condition("a display that is not there", surroundings(DISPLAY=":99", MUJOCO_GL=None)),
    Condition("no network", before("unshare", "-n"), needs="unshare"),
    Condition("clock going back", clock_back, needs="faketime"),
    Condition("files private (umask 077)", shell('umask 077; "$@"')),
    Condition("stdin closed", shell('"$@" <&-')),
    Condition("stdout closed", shell('"$@" >&-')),
    Condition("stderr closed", shell('"$@" 2>&-')),
    Condition(
        "stdout into head -0",
        shell('"$@" | head -n 0 > /dev/null; exit $(( PIPESTATUS[0] == 1 ? 0 : PIPESTATUS[0] ))'),
    ),
    Condition("stdout on a full device", shell('"$@" > /dev/full'), must_work=False),
)


def table(tallies: list[Tally]) -> str:
    """Markdown."""
    columns = ("condition", "runs", "work done", "refused in one line", "anything else")
    rows = [(t.condition, t.runs or t.left_out, t.done, t.refused, t.wrong or "none") for t in tallies]
    return markdown(columns, rows)


if __name__ == "__main__":
    main()
