"""The work of `vr undistort`."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import cv2

from vision_robot.errors import BadParameter, UnwritableOutput
from vision_robot.files import check_place, write_bytes
from vision_robot.flatten import Flattener
from vision_robot.formats import SUFFIXES, check_writable, read_camera, write_camera
from vision_robot.geometry.flat_camera import flat_camera
from vision_robot.images import VIDEO_SUFFIXES, open_images
from vision_robot.video import CODECS, Video, VideoWriter
from vision_robot_cli.output import progress

__all__ = ["undistorted"]


def undistorted(
    paths: Sequence[str],
    camera_file: Path | None,
    camera_name: str | None,
    keep: str,
    out: Path,
    file_format: str | None,
) -> dict[str, Any]:
    """Write the flat pictures and their camera; what was done, for the person and for --json."""
    if camera_file is None:
        raise BadParameter("--camera", None, "given: the camera file of these pictures")
    source = read_camera(camera_file, name=camera_name)
    target = flat_camera(source, keep)
    as_video = out.suffix.lower() in CODECS
    beside = out.with_name(f"{out.stem}_camera") if as_video else out / "camera"
    place = beside.with_suffix(_suffix(file_format))
    check_writable(place, file_format, model="pinhole", skew=target.skew != 0)
    flatten = Flattener(source, target)
    if as_video:
        check_place(out)
        count = _video(paths, flatten, out)
    else:
        if out.exists() and not out.is_dir():
            raise UnwritableOutput(out, "it is a file; give a folder, or a video's name")
        count = _pictures(paths, flatten, out)
    write_camera(target, place, file_format)
    return {
        "pictures": count,
        "out": str(out),
        "keep": keep,
        "camera_file": str(place),
        "camera": asdict(target),
    }


def _suffix(file_format: str | None) -> str:
    if file_format is None:
        return ".json"
    fitting = [suffix for suffix, name in SUFFIXES.items() if name == file_format]
    return fitting[0] if fitting else ".yaml"


def _pictures(paths: Sequence[str], flatten: Flattener, out: Path) -> int:
    pictures = open_images(paths)
    names = {name: Path(name.replace("#", "_")).name for name in pictures}
    if len(set(names.values())) < len(names):
        raise BadParameter("pictures", "two of one name", "of different names: give one folder at a time")
    for name in progress(pictures, "undistorting", total=len(pictures)):
        file = Path(names[name])
        # Lossless, whatever came in: the picture was resampled once and shall not lose again.
        written, data = cv2.imencode(".png", flatten(pictures[name], name))
        assert written
        write_bytes(out / f"{file.stem if file.suffix else file.name}.png", data.tobytes())
    return len(names)


def _video(paths: Sequence[str], flatten: Flattener, out: Path) -> int:
    if len(paths) != 1 or Path(paths[0]).suffix.lower() not in VIDEO_SUFFIXES:
        raise BadParameter("input", ", ".join(paths), f"one video where the output is one ({out})")
    if Path(paths[0]).resolve() == out.resolve():
        raise BadParameter("--out", str(out), "another file than the input")
    video = Video(paths[0])
    count = 0
    with VideoWriter(out, video.size, video.fps) as writer:
        for frame in progress(video, "undistorting", total=video.frame_count):
            writer.write(flatten(frame.image, f"frame {frame.index}"))
            count += 1
    return count
