"""Any program that reads a video and writes a CSV of tracks."""

import shlex
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

from vision_robot.errors import BadParameter, PeerFailed
from vision_robot.tracks import Tracks
from vision_robot.types import Image
from vision_robot.video import VideoWriter

__all__ = ["tracks_of_command"]


def tracks_of_command(
    command: str, frames: Iterable[Image], size: tuple[int, int], fps: float, *, patience_s: float = 3600
) -> Tracks:
    """The tracks that ``command`` writes to the place of its ``{out}`` from the video at ``{video}``.

    The words are split as a shell would and no shell is run. The video is lossless; the CSV has at least
    the columns frame, id, u_px and v_px of `Tracks`. Raises BadParameter for a command without both
    places, PeerFailed with the program's last words when it fails, BadTable for a CSV that is none.
    """
    if "{video}" not in command or "{out}" not in command:
        raise BadParameter("command", command, "a command line with the places {video} and {out}")
    with tempfile.TemporaryDirectory() as folder:
        video, out = Path(folder) / "video.mkv", Path(folder) / "tracks.csv"
        with VideoWriter(video, size, fps) as writer:
            for frame in frames:
                writer.write(frame)
        places = {"{video}": str(video), "{out}": str(out)}
        words = [_filled(word, places) for word in shlex.split(command)]
        try:
            ended = subprocess.run(
                words, capture_output=True, text=True, errors="replace", check=False, timeout=patience_s
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            raise PeerFailed(command, str(error)) from error
        if ended.returncode != 0:
            last = (ended.stderr.strip() or ended.stdout.strip() or "it said nothing").splitlines()[-1]
            raise PeerFailed(command, f"exit code {ended.returncode}: {last}")
        return Tracks.read(out)


def _filled(word: str, places: dict[str, str]) -> str:
    for place, path in places.items():
        word = word.replace(place, path)
    return word
