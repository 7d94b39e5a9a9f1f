"""Pictures of the manual, made by the tool itself: `python docs/pictures.py [NAME ...]`.

Each is a page or a figure that a command writes, or a frame it renders. Pages are photographed by a
headless chromium, and everything is kept small (WebP). The commands take some minutes; the results are
in the repository, so that building the manual needs none of it.
"""

import argparse
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from vision_robot.images import read_image
from vision_robot.video import Video

PICTURES = Path(__file__).parent / "pictures"
WIDTH = 1160
QUALITY = 72
ABOVE = 50
"""Frame of `cell` in which the gripper is over the pencil."""
NARROW = "width: 680px; margin: 20px"


def made(folder: Path, name: str, words: str) -> Path:
    """The file that a command of the tool writes into a folder; run only where it is not there yet."""
    if (folder / name).exists():
        return folder / name
    command = [sys.executable, "-m", "vision_robot_cli.main", *shlex.split(words)]
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return folder / name


def photographed(page: Path, height: int) -> np.ndarray:
    """The top of an HTML page as a picture."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        sys.exit("chromium is needed: apt-get install chromium")
    shot = page.with_suffix(".png")
    command = [chromium, "--headless", "--no-sandbox", "--hide-scrollbars", f"--window-size={WIDTH},{height}"]
    subprocess.run(
        [*command, f"--screenshot={shot}", page.as_uri()], check=True, capture_output=True, timeout=120
    )
    image = cv2.imread(str(shot))
    assert image is not None
    return image


def figure_of(page: Path, words: str, height: int = 1000) -> np.ndarray:
    """The figure of a report that holds these words, alone on a page."""
    text = page.read_text(encoding="utf-8")
    style = "".join(re.findall(r"<style>.*?</style>", text, re.DOTALL))
    for figure in re.findall(r"<figure.*?</figure>", text, re.DOTALL):
        if words in re.sub(r"<svg.*?</svg>", "", figure, flags=re.DOTALL):
            alone = page.with_name("figure.html")
            content = f"<!doctype html><meta charset=utf-8>{style}<body><div style='{NARROW}'>{figure}</div>"
            alone.write_text(content, encoding="utf-8")
            return trimmed(photographed(alone, height))
    sys.exit(f"{page.name} has no figure about {words}")


def trimmed(image: np.ndarray, margin: int = 12) -> np.ndarray:
    """Without the empty border."""
    differs = (np.abs(image.astype(int) - image[0, 0]).max(axis=-1) > 6).nonzero()
    top, left = (max(0, int(axis.min()) - margin) for axis in differs)
    bottom, right = (int(axis.max()) + margin for axis in differs)
    return image[top:bottom, left:right]


def calibration_report(folder: Path) -> Path:
    """The page of a calibration of rendered views."""
    return made(folder, "camera.html", "calibrate -o camera.json --report camera.html")


def calibration(folder: Path) -> np.ndarray:
    """Its top."""
    return photographed(calibration_report(folder), 780)


def projection_uncertainty(folder: Path) -> np.ndarray:
    """Its map of how well projection is known."""
    return figure_of(calibration_report(folder), "Uncertainty [px] of the projection of points at infinity")


def plane(folder: Path) -> np.ndarray:
    """Camera and table in space, on the page of a work plane."""
    page = made(folder, "plane.html", "extrinsics plane --synthetic -o plane.json --report plane.html")
    return figure_of(page, "Figure 1.")


def arm(folder: Path) -> np.ndarray:
    """Where the tool reaches, on the page of an arm."""
    return figure_of(made(folder, "arm.html", "ik check column --report arm.html"), "Figure 1.")


def seen(folder: Path) -> np.ndarray:
    """A late frame of the overlay of a tracker, as in the tutorial."""
    made(folder, "rod/video.mp4", "synth single-rod -o rod --frames 60 --mp4")
    words = "track video rod/video.mp4 --tracker rgb --color red --plane rod/dataset.json --overlay seen.mp4"
    frames = [frame.image for frame in Video(made(folder, "seen.mp4", words))]
    return frames[24]


def cell(folder: Path) -> np.ndarray:
    """The gripper over a pencil, as the camera of the cell sees it."""
    words = "synth gripper-approach -o approach --frames 110 --severity 1"
    frames = sorted((made(folder, "approach", words) / "frames").iterdir())
    return read_image(frames[ABOVE])


def benchmark(folder: Path) -> np.ndarray:
    """The page of a benchmark."""
    words = "benchmark calibration --seeds 4 --workers 2 -o bench --report benchmark.html"
    return photographed(made(folder, "benchmark.html", words), 780)


MAKERS: dict[str, Callable[[Path], np.ndarray]] = {
    maker.__name__: maker
    for maker in (calibration, projection_uncertainty, plane, arm, seen, cell, benchmark)
}


def main() -> None:
    """Make all pictures, or those that are named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(MAKERS))
    parser.add_argument("--folder", type=Path, help="where the commands write; else a temporary folder")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name in given.names or MAKERS:
            image = MAKERS[name](folder.resolve())
            cv2.imwrite(str(PICTURES / f"{name}.webp"), image, [cv2.IMWRITE_WEBP_QUALITY, QUALITY])
            print(name, image.shape[1], image.shape[0], file=sys.stderr)


if __name__ == "__main__":
    main()
