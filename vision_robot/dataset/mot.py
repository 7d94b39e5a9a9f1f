"""The layout of MOTChallenge: a folder with img1/, gt/gt.txt and, mostly, seqinfo.ini.

A row of gt.txt is frame, id, left, top, width, height, then whether it counts, class and visibility;
frames and pixels count from 1, so that the house's left border is ``left - 1.5``.
"""

import configparser
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from vision_robot.dataset.box_tracks import tracks_of_boxes
from vision_robot.dataset.dataset import Dataset, even_times
from vision_robot.dataset.folder import inside, numbered_pictures, picture_size
from vision_robot.dataset.layout import Layout
from vision_robot.dataset.numbers import read_numbers
from vision_robot.errors import BadDataset, BadTable
from vision_robot.reading import read_text
from vision_robot.tracks import Tracks
from vision_robot.types import Array, Float
from vision_robot.video import Video

__all__ = ["LAYOUT", "mot_text", "read_mot", "sequence_text"]

FIRST_PIXEL = 1.5
"""Their pixel 1 has its centre at our 0 and its left border at -0.5."""
USUAL_FPS = 30.0


def recognises(folder: Path) -> bool:
    """A sequence folder."""
    return (folder / "gt" / "gt.txt").is_file() or (folder / "seqinfo.ini").is_file()


def read(folder: Path) -> Dataset:
    """A MOTChallenge sequence as a dataset. Raises BadDataset or BadTable for what is no such folder."""
    info = _sequence(folder / "seqinfo.ini")
    pictures = inside(folder, info.get("imdir", "img1"))
    fps = _number(folder, info, "framerate", USUAL_FPS)
    source = Video(pictures) if pictures.is_file() else numbered_pictures(pictures, "MOTChallenge")
    count = (source.frame_count or 0) if isinstance(source, Video) else len(source)
    size = source.size if isinstance(source, Video) else picture_size(source[0])
    times = even_times(count, fps)
    truth, ignored = read_mot(folder / "gt" / "gt.txt", times)
    return Dataset(
        name=info.get("name", folder.name),
        path=folder,
        layout="mot",
        size=size,
        fps=fps,
        source=source,
        times_s=times,
        truth=truth,
        ignored=ignored,
        described=info,
    )


def read_mot(path: Path, times_s: Float[Array, "frames"]) -> tuple[Tracks, Tracks]:
    """What counts and what does not (marked 0) in a gt.txt of a sequence with those frames.

    Raises BadTable, naming the line, for rows that are no boxes or lie outside the sequence.
    """
    rows, lines = read_numbers(path, 6, 10)
    for i, line in enumerate(lines):
        frame, id_, _, _, width, height = rows[i, :6]
        if not np.isfinite(rows[i, :6]).all():
            raise BadTable(path, f"line {line}: frame, id and box must be finite numbers")
        if not (frame == int(frame) and id_ == int(id_)):
            raise BadTable(path, f"line {line}: frame {frame:g} and id {id_:g} must be whole numbers")
        if not 1 <= frame <= len(times_s):
            raise BadTable(path, f"line {line}: frame {frame:g}, the sequence has 1 to {len(times_s)}")
        if not (width > 0 and height > 0):
            raise BadTable(path, f"line {line}: a box of {width:g} x {height:g} px")
    frame, id_ = rows[:, 0].astype(np.int64) - 1, rows[:, 1].astype(np.int64)
    twice = np.flatnonzero(_repeats(frame, id_))
    if twice.size:
        i = int(twice[0])
        raise BadTable(path, f"line {lines[i]}: object {id_[i]} a second time in frame {frame[i] + 1}")
    box = rows[:, 2:6] - (FIRST_PIXEL, FIRST_PIXEL, 0, 0)
    # Rows of ten numbers are those of 2015, whose last three are positions in the world.
    extra = {"class": rows[:, 7], "visible": rows[:, 8]} if np.isnan(rows[:, 9]).all() else {}
    everything = tracks_of_boxes(frame, id_, box, times_s, {**extra, "counts": rows[:, 6]})
    counts = everything.extra["counts"] != 0
    left = {name: column for name, column in everything.extra.items() if name != "counts"}
    everything = Tracks(**{**vars(everything), "extra": left})
    return everything.rows(counts), everything.rows(~counts)


def mot_text(tracks: Tracks, visible: Float[Array, "n"] | None = None) -> str:
    """A gt.txt of these tracks, all of class 1; rows without a box are left out."""
    seen = np.isfinite(tracks.box_px).all(axis=1) & (tracks.box_px[:, 2:] > 0).all(axis=1)
    visible = np.ones(len(tracks)) if visible is None else np.nan_to_num(visible, nan=1.0)
    lines: Iterable[str] = (
        f"{tracks.frame[i] + 1},{tracks.id[i]},"
        + ",".join(f"{value:.3f}" for value in tracks.box_px[i] + (FIRST_PIXEL, FIRST_PIXEL, 0, 0))
        + f",1,1,{visible[i]:.4f}\n"
        for i in np.flatnonzero(seen)
    )
    return "".join(lines)


def sequence_text(name: str, folder: str, fps: float, count: int, size: tuple[int, int], suffix: str) -> str:
    """A seqinfo.ini."""
    width, height = size
    return (
        f"[Sequence]\nname={name}\nimDir={folder}\nframeRate={fps:g}\nseqLength={count}\n"
        f"imWidth={width}\nimHeight={height}\nimExt={suffix}\n"
    )


def _repeats(frame: Array, id_: Array) -> Array:
    """Which rows repeat the frame and id of an earlier one."""
    _, first = np.unique(np.stack([frame, id_]), axis=1, return_index=True)
    repeats = np.ones(len(frame), dtype=bool)
    repeats[first] = False
    return repeats


def _sequence(path: Path) -> dict[str, str]:
    if not path.is_file():
        return {}
    parser = configparser.ConfigParser(interpolation=None)
    try:
        parser.read_string(read_text(path, BadDataset))
        return dict(parser["Sequence"])
    except (configparser.Error, KeyError) as error:
        raise BadDataset(path, "a seqinfo.ini starts with [Sequence] and holds name=value lines") from error


def _number(folder: Path, info: dict[str, str], name: str, otherwise: float) -> float:
    text = info.get(name, str(otherwise))
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 < value < 1e6:
        raise BadDataset(folder / "seqinfo.ini", f"{name} is {text!r}, not a positive number")
    return value


LAYOUT = Layout("gt/gt.txt", recognises, read)
