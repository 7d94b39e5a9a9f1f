"""What runs for `fuzz.py --atheris-path`: libFuzzer spoils files so that new branches are reached.

    python fuzz_guided.py DIR READER CORPUS SECONDS

DIR holds the package atheris, CORPUS is an empty folder. The last line of stdout is a JSON object.
"""

import json
import os
import sys
import tempfile
from importlib import import_module
from pathlib import Path
from time import monotonic

ROOT = Path(__file__).resolve().parents[1]


def main(atheris_path: str, reader: str, corpus: str, seconds: str) -> None:
    """Fuzz until the time is over; does not return."""
    sys.path[:0] = [str(ROOT)]
    sys.path.append(atheris_path)
    atheris = import_module("atheris")

    with atheris.instrument_imports(include=["vision_robot", "vision_robot_cli", "vision_robot_synth"]):
        from tests.fuzz.limits import limit_memory
        from tests.fuzz.readers import SUBJECTS
        from tests.fuzz.subject import Case, attempt

    subject = SUBJECTS[reader]
    folder = Path(tempfile.mkdtemp(dir=corpus)) / "case"
    folder.mkdir()
    seeds = subject.seeds(folder.parent / "seeds")
    grown = Path(corpus) / "grown"
    grown.mkdir()
    name = next(name for name in seeds[0] if name not in subject.kept)
    for i, seed in enumerate(seeds):
        if name in seed:
            (grown / f"seed{i}").write_bytes(seed[name])
    attempt(subject, Case(subject, seeds, 0).write, folder)
    limit_memory(3000)  # coverage needs some of it
    until, failures, inputs = monotonic() + float(seconds), {}, 0

    def one(data: bytes) -> None:
        nonlocal inputs
        inputs += 1
        end = attempt(subject, Case(subject, [{**seeds[0], name: data}], 0).write, folder)
        if end not in ("read", "refused"):
            failures.setdefault(end[:160], data[:2000].hex())
        if monotonic() > until:
            print(json.dumps({"inputs": inputs, "failures": failures}), flush=True)
            os._exit(0)  # libFuzzer would call any other end a crash

    atheris.Setup([sys.argv[0], "-rss_limit_mb=0", "-max_len=20000", "-verbosity=0", str(grown)], one)
    atheris.Fuzz()


if __name__ == "__main__":
    main(*sys.argv[1:])
