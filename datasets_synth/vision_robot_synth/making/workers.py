"""Frames shared out among processes, each with its own cell and OpenGL context."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing.connection import Connection

import cv2

from vision_robot_synth.making.frame_files import Workshop
from vision_robot_synth.making.maker import Maker
from vision_robot_synth.scene.scene import Scene

__all__ = ["make_frames"]

LONGEST = 24
"""Frames handed out at a time: few, to share evenly; many, because flow takes one frame more each time."""

_maker: Maker | None = None


def make_frames(scene: Scene, workshop: Workshop, frames: list[int], workers: int) -> Iterator[int]:
    """Make these frames, which rise, on so many processes; gives each frame's number when it is done.

    The bytes do not depend on the number of processes.
    """
    if not frames:
        return
    if workers == 1 or len(frames) == 1:
        with Maker(scene, workshop) as maker:
            for start, stop in _stretches(frames, len(frames)):
                yield from maker.make(start, stop)
        return
    size = max(1, min(LONGEST, len(frames) // (3 * workers)))
    context = multiprocessing.get_context("spawn")
    watched, held = context.Pipe(duplex=False)
    with held, watched, ProcessPoolExecutor(workers, context, _begin, (scene, workshop, watched)) as pool:
        try:
            tasks = [pool.submit(_make, start, stop) for start, stop in _stretches(frames, size)]
            for task in as_completed(tasks):
                yield from task.result()
        except BaseException:
            # Whoever interrupts does not wait for frames under way; whole files are all that they leave.
            held.close()
            pool.shutdown(wait=True, cancel_futures=True)
            raise


def _stretches(frames: list[int], longest: int) -> Iterator[tuple[int, int]]:
    """Frames as stretches (start, stop) without gaps, of at most `longest`."""
    start = stop = frames[0]
    for frame in frames:
        if frame != stop or stop - start >= longest:
            yield start, stop
            start = frame
        stop = frame + 1
    yield start, stop


def _begin(scene: Scene, workshop: Workshop, watched: Connection) -> None:
    global _maker  # noqa: PLW0603 - a process has one OpenGL context
    # An interrupt is the parent's to handle.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(watched,), daemon=True).start()
    cv2.setNumThreads(1)
    _maker = Maker(scene, workshop)


def _end_with(watched: Connection) -> None:
    """End when the other end is closed: by the parent, or with it when it is killed."""
    try:
        watched.recv()
    except (EOFError, OSError):
        os._exit(1)


def _make(start: int, stop: int) -> list[int]:
    assert _maker is not None, "the pool begins with it"
    return list(_maker.make(start, stop))
