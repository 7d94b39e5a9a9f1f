"""What is left of a long command that is killed or interrupted at any moment, and what the next run does.

Each command is run once undisturbed. Then, in a folder of its own, it is killed with SIGKILL at three random
moments, one after the other, and run to its end: files must be as those of the undisturbed run (byte by byte
but for pages that tell how long things took), none missing, half-written, doubled or left over. While it is
dead, every file in its place must be whole. Then it is interrupted as by Ctrl-C at a random moment: it
must end with 130 and one line, within a second, and the run after that must be right too.
"""

import argparse
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from long_commands import COMMANDS, LongCommand, contents, material, run, start, whole
from table import markdown, shown

KILLS = 3
PATIENCE_S = 1.0


@dataclass
class Tally:
    """What came of one command."""

    command: str
    seconds: float = 0.0
    kills: int = 0
    half_written: int = 0
    orphans: int = 0
    resumed: int = 0
    resumed_right: int = 0
    left_over: int = 0
    interrupts: int = 0
    interrupted_well: int = 0
    slowest_interrupt_s: float = 0.0
    first_wrong: str = ""


def main() -> None:
    """Print the table."""
    asked = arguments()
    names = [name for name in COMMANDS if not asked.only or any(only in name for only in asked.only)]
    tallies = []
    with tempfile.TemporaryDirectory(prefix="vr kill ") as place:
        material(Path(place) / "in")
        for name in names:
            tallies.append(tried(COMMANDS[name], Path(place), asked.rounds, asked.seed))
            print(f"{name}: {tallies[-1].first_wrong or 'all well'}", file=sys.stderr, flush=True)
    print(shown("vr.benchmark.kill/1", [asdict(one) for one in tallies], table(tallies), as_json=asked.json))


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", action="append", help="Only commands whose names hold this.")
    parser.add_argument("--rounds", type=int, default=4, help="Rounds of three kills and one interrupt.")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--quick", action="store_true", help="Only show that it runs.")
    parser.add_argument("--json", action="store_true")
    asked = parser.parse_args()
    if asked.quick:
        asked.rounds, asked.only = 1, ["ik export"]
    return asked


def tried(command: LongCommand, place: Path, rounds: int, seed: int) -> Tally:
    """All rounds of a command."""
    tally, rng = Tally(command.name), random.Random(f"{command.name} {seed}")
    out = place / "out"
    fresh(out)
    undisturbed = run(command.command(place / "in", out))
    if undisturbed.code:
        tally.first_wrong = f"undisturbed it ends with {undisturbed.code}: {undisturbed.err.strip()[-200:]}"
        return tally
    tally.seconds, right = undisturbed.seconds, contents(out)
    for _ in range(rounds):
        fresh(out)
        for _ in range(KILLS):
            killed(command, place, tally, rng, right)
        finished(command, place, tally, right)
        fresh(out)
        interrupted(command, place, tally, rng)
        finished(command, place, tally, right)
    return tally


def killed(
    command: LongCommand, place: Path, tally: Tally, rng: random.Random, right: dict[str, str]
) -> None:
    """Kill it at a random moment; look at what stands there."""
    process = start(command.command(place / "in", place / "out"))
    time.sleep(rng.uniform(0.05, 1.0) * tally.seconds)
    if process.poll() is None:
        tally.kills += 1
    process.kill()  # it alone: its workers must notice
    process.wait()
    if not gone(process.pid, 10.0):
        tally.orphans += 1
        os.killpg(process.pid, signal.SIGKILL)
        tally.first_wrong = tally.first_wrong or "workers live on"
    for name in half_written(command, place / "out", right):
        tally.half_written += 1
        tally.first_wrong = tally.first_wrong or f"{name} after a kill"


def half_written(command: LongCommand, out: Path, right: dict[str, str]) -> list[str]:
    """Files at their places that are not whole; temporary ones, whose names begin with a dot, may be."""
    wrong = whole(command, out, right)
    return [
        text
        for text in wrong
        if not text.endswith(("is missing", "is too many"))
        and not any(p.startswith(".") for p in Path(text).parts)
    ]


def gone(group: int, seconds: float) -> bool:
    """Whether nobody of a session is left after so long."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.05)
    return False


def finished(command: LongCommand, place: Path, tally: Tally, right: dict[str, str]) -> None:
    """Run it to its end where it was cut short before."""
    ended = run(command.command(place / "in", place / "out"))
    wrong = [f"it ends with {ended.code}: {ended.err[-200:]}"] if ended.code else []
    wrong += whole(command, place / "out", right)
    tally.resumed += 1
    litter = [text for text in wrong if text.endswith("is too many")]
    tally.left_over += len(litter)
    tally.resumed_right += not [text for text in wrong if text not in litter]
    if wrong:
        tally.first_wrong = tally.first_wrong or f"{wrong[0]} after running again"


def interrupted(command: LongCommand, place: Path, tally: Tally, rng: random.Random) -> None:
    """Ctrl-C: the whole foreground hears it."""
    process = start(command.command(place / "in", place / "out"))
    time.sleep(rng.uniform(0.1, 0.9) * tally.seconds)
    begin = time.monotonic()
    if process.poll() is None:
        tally.interrupts += 1
    with suppress(ProcessLookupError):  # it may have ended by itself just now
        os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate()
    took = time.monotonic() - begin
    tally.slowest_interrupt_s = max(tally.slowest_interrupt_s, took)
    # To a shell an end by the signal itself is 130 as well.
    well = process.returncode in (130, -signal.SIGINT) or (process.returncode == 0 and took < PATIENCE_S)
    well = well and "Traceback" not in out + err and gone(process.pid, 10.0)
    tally.interrupted_well += well and took < PATIENCE_S
    if not well or took >= PATIENCE_S:
        told = f"Ctrl-C: ended with {process.returncode} after {took:.1f} s: {err.strip()[-160:]}"
        tally.first_wrong = tally.first_wrong or told


def fresh(folder: Path) -> None:
    """An empty folder."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()


def table(tallies: list[Tally]) -> str:
    """Markdown."""
    columns = (
        "command",
        "takes, s",
        "kills",
        "half-written",
        "workers left",
        "run again",
        "right",
        "left over",
        "Ctrl-C",
        "well",
        "slowest, s",
    )
    rows = [
        (
            t.command,
            f"{t.seconds:.1f}",
            t.kills,
            t.half_written,
            t.orphans,
            t.resumed,
            t.resumed_right,
            t.left_over,
            t.interrupts,
            t.interrupted_well,
            f"{t.slowest_interrupt_s:.2f}",
        )
        for t in tallies
    ]
    return markdown(columns, rows)


if __name__ == "__main__":
    main()
