"""What is fuzzed: a reader, good inputs for it, and what counts as a good end."""

import os
import shutil
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from random import Random

from tests.fuzz.mutations import mutated
from vision_robot.errors import BadInput, VisionRobotError

__all__ = ["Case", "Files", "Subject", "attempt"]

Files = Mapping[str, bytes]


@dataclass(frozen=True)
class Subject:
    """A reader. `make` writes good inputs, each a folder of files; `read` reads such a folder."""

    name: str
    make: Callable[[Path], Sequence[Path]]
    """Fills an empty folder with folders; gives them."""
    read: Callable[[Path], object]
    kept: tuple[str, ...] = ()
    """Files that are left as they are."""
    ends: tuple[type[Exception], ...] = (BadInput,)
    """Errors that are a good end."""

    def seeds(self, folder: Path) -> list[Files]:
        """The good inputs as names and bytes."""
        folder.mkdir(parents=True)
        made = self.make(folder)
        found: list[Files] = [
            {
                str(path.relative_to(one)): path.read_bytes()
                for path in sorted(one.rglob("*"))
                if path.is_file()
            }
            for one in made
        ]
        shutil.rmtree(folder)
        return found


@dataclass(frozen=True)
class Case:
    """Input number `number` of a subject; the same every time."""

    subject: Subject
    seeds: Sequence[Files]
    number: int

    @cached_property
    def files(self) -> Files:
        """Names and bytes, one file of them spoiled; number 0 and the like of it are the good ones."""
        if self.number < len(self.seeds):
            return self.seeds[self.number]
        rng = Random(f"{self.subject.name} {self.number}")
        good = rng.choice(self.seeds)
        name = rng.choice([name for name in good if name not in self.subject.kept])
        others = [seed[name] for seed in self.seeds if name in seed]
        return {**good, name: mutated(good[name], rng, others)}

    def write(self, folder: Path) -> None:
        """Put the files into an empty folder."""
        for name, data in self.files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(data)


def attempt(subject: Subject, write: Callable[[Path], object], folder: Path) -> str:
    """Read what `write` puts into an empty folder: "read", "refused", or what went wrong."""
    inside = folder / "inside"
    inside.mkdir()
    write(inside)
    before = Path.cwd()
    os.chdir(folder)  # so that what is written to a careless place is seen
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            subject.read(inside)
        end = "read"
    except subject.ends as error:
        text = str(error)
        end = "refused"
        if not text.isprintable() or len(text) > 10_000 or not isinstance(error, VisionRobotError):
            end = f"its line cannot be shown: {text[:200]!r}"
    except MemoryError:
        end = "out of memory"
    except Exception as error:
        end = f"{type(error).__name__}: {str(error)[:300]}"
    finally:
        os.chdir(before)
    left = [path.name for path in folder.iterdir() if path.name != "inside"]
    shutil.rmtree(folder)
    folder.mkdir()
    return f"wrote {', '.join(left)}" if left else end
