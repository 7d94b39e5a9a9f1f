"""What every reader does with spoiled files: is anything but a clear refusal ever the end?

Good files of every kind, made by our own writers, are spoiled in reproducible ways (tests/fuzz/mutations.py)
and read in processes of their own, whose memory and time are limited. A file must be read, or refused with
one printable line. Anything else counts: another exception, a warning, a crash, more than SECONDS for one
file, more than MEGABYTES over what the process had before, a file written anywhere. Case K of a reader is
the same every time: `--only READER --first K --count 1` repeats it.

With `--atheris-path DIR` (where `pip install --target DIR atheris` put it) coverage guides further inputs.
"""

import argparse
import json
import multiprocessing
import os
import resource
import sys
import tempfile
from collections import Counter
from dataclasses import asdict, dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from time import perf_counter

from table import markdown, shown

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.fuzz.command_lines import COMMAND_LINES  # noqa: E402
from tests.fuzz.limits import limit_memory, resident_mb  # noqa: E402
from tests.fuzz.readers import SUBJECTS as READERS  # noqa: E402
from tests.fuzz.subject import Case, attempt  # noqa: E402

SUBJECTS = READERS | COMMAND_LINES
SHARE = 20
"""Whole commands get one in so many of the cases of a reader."""
SECONDS = 20.0
MEGABYTES = 1500
GOOD_ENDS = ("read", "refused")


@dataclass
class Tally:
    """What came of one reader's inputs."""

    reader: str
    inputs: int = 0
    read: int = 0
    refused: int = 0
    slowest_s: float = 0.0
    peak_mb: float = 0.0
    failures: dict[str, int] = field(default_factory=dict)
    """What went wrong, and the first case that showed it."""
    failed: int = 0
    guided: int = 0
    """Inputs that coverage chose."""


def main() -> None:
    """Print the table."""
    asked = arguments()
    names = [name for name in SUBJECTS if not asked.only or any(only in name for only in asked.only)]
    tallies = []
    for name in names:
        count = -(-asked.count // SHARE) if name in COMMAND_LINES else asked.count
        tally = fuzzed(name, asked.first, count, asked.seconds)
        if asked.atheris_path and name in READERS:
            guided(tally, asked.atheris_path, asked.guided_seconds)
        tallies.append(tally)
        print(f"{name}: {tally.inputs} inputs, {tally.failed} failures", file=sys.stderr, flush=True)
        for what, case in tally.failures.items():
            print(f"    case {case}: {what}", file=sys.stderr, flush=True)
    print(shown("vr.benchmark.fuzz/1", [asdict(one) for one in tallies], table(tallies), as_json=asked.json))
    sys.exit(1 if any(tally.failed for tally in tallies) else 0)


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", action="append", help="Only readers whose names hold this.")
    parser.add_argument("--first", type=int, default=0, help="Number of the first case.")
    parser.add_argument("--count", type=int, default=3000, help="Cases of each reader.")
    parser.add_argument("--seconds", type=float, default=1e9, help="At most so long for each reader.")
    parser.add_argument("--atheris-path", help="Folder that holds the package atheris.")
    parser.add_argument("--guided-seconds", type=int, default=20, help="Time of coverage guided inputs.")
    parser.add_argument("--quick", action="store_true", help="Only show that it runs.")
    parser.add_argument("--json", action="store_true")
    asked = parser.parse_args()
    if asked.quick:
        asked.count, asked.only = 5, ["camera .json", "tracks", "picture .png", "vr convert"]
    return asked


def fuzzed(name: str, first: int, count: int, seconds: float) -> Tally:
    """Cases `first` to before `first + count`; a process that dies is replaced by another."""
    tally, ends, number = Tally(name), Counter[str](), first
    until = perf_counter() + seconds
    context = multiprocessing.get_context("fork")  # cheap, and nothing here has threads yet
    while number < first + count and perf_counter() < until:
        here, there = context.Pipe(duplex=False)
        child = context.Process(target=work, args=(name, number, first + count, there))
        child.start()
        there.close()
        died, started = "", number
        while perf_counter() < until:
            # Before its first answer it imports what it needs, which is not the file's fault.
            if not here.poll(SECONDS if number > started else 10 * SECONDS):
                died = f"more than {SECONDS:g} s"
                break
            try:
                end, took, peak = here.recv()
            except EOFError:
                break
            note(tally, ends, number, end)
            tally.slowest_s, tally.peak_mb = max(tally.slowest_s, took), max(tally.peak_mb, peak)
            number += 1
        child.kill() if died or perf_counter() >= until else None
        child.join()
        if not died and child.exitcode not in (0, None) and number < first + count and perf_counter() < until:
            died = f"the process ended with {child.exitcode}"
        if died:
            note(tally, ends, number, died)
            number += 1
    tally.read, tally.refused = ends["read"], ends["refused"]
    return tally


def note(tally: Tally, ends: Counter[str], number: int, end: str) -> None:
    """Count one end."""
    ends[end] += 1
    tally.inputs += 1
    if end not in GOOD_ENDS:
        tally.failed += 1
        if len(tally.failures) < 20:
            tally.failures.setdefault(end[:160], number)


def work(name: str, first: int, stop: int, answers: Connection) -> None:
    """In a process of its own: the cases one after the other."""
    silence()
    subject = SUBJECTS[name]
    with tempfile.TemporaryDirectory(dir=fast_folder()) as root:
        seeds = subject.seeds(Path(root) / "seeds")
        folder = Path(root) / "case"
        folder.mkdir()
        attempt(subject, Case(subject, seeds, 0).write, folder)  # what it imports is not the file's fault
        limit_memory(MEGABYTES)
        for number in range(first, stop):
            before, start = resident_mb(), perf_counter()
            end = attempt(subject, Case(subject, seeds, number).write, folder)
            took = perf_counter() - start
            peak = max(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024 - before, 0.0)
            answers.send((end, took, peak))
    answers.close()


def silence() -> None:
    """What decoders print of damaged pictures."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


def fast_folder() -> str | None:
    """In memory, where the system has such a place."""
    return "/dev/shm" if Path("/dev/shm").is_dir() else None


def guided(tally: Tally, atheris_path: str, seconds: int) -> None:
    """Inputs that reach new branches of our Python, for so many seconds."""
    import subprocess

    script = Path(__file__).with_name("fuzz_guided.py")
    with tempfile.TemporaryDirectory(dir=fast_folder()) as corpus:
        done = subprocess.run(
            [sys.executable, str(script), atheris_path, tally.reader, corpus, str(seconds)],
            capture_output=True,
            text=True,
            check=False,
            timeout=seconds + 300,
        )
    try:
        found = json.loads(done.stdout.splitlines()[-1])
    except (IndexError, ValueError):
        found = {"inputs": 0, "failures": {f"guided run ended with {done.returncode}": done.stderr[-200:]}}
    tally.guided = found["inputs"]
    for what, example in found["failures"].items():
        tally.failed += 1
        tally.failures[what] = example


def table(tallies: list[Tally]) -> str:
    """Markdown."""
    columns = ("reader", "spoiled files", "read", "refused", "guided", "anything else", "slowest, s")
    rows: list[tuple[object, ...]] = [
        (t.reader, t.inputs, t.read, t.refused, t.guided or "", t.failed or "none", f"{t.slowest_s:.2f}")
        for t in tallies
    ]
    whole = [
        sum(getattr(t, name) for t in tallies) for name in ("inputs", "read", "refused", "guided", "failed")
    ]
    slowest = max((t.slowest_s for t in tallies), default=0.0)
    rows.append(("all", *whole[:3], whole[3] or "", whole[4] or "none", f"{slowest:.2f}"))
    return markdown(columns, rows)


if __name__ == "__main__":
    main()
