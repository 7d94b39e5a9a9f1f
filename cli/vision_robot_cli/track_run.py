"""One run of `vr track video` or `vr track camera`: steps through the session, files written as it goes."""

import shlex
import sys
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vision_robot.errors import BadInput, BadParameter
from vision_robot.files import check_place
from vision_robot.track.history import History
from vision_robot.track.overlay import Overlay
from vision_robot.track.row_writers import row_writer
from vision_robot.track.session import Session, Step
from vision_robot.track.sources import Source
from vision_robot.types import Image
from vision_robot.video import CODECS, VideoWriter
from vision_robot_cli.output import note

__all__ = ["Outputs", "Run"]


@dataclass(frozen=True)
class Outputs:
    """Where things go; None for not wanted."""

    rows: Path | None = None
    overlay: Path | None = None
    report: Path | None = None
    rerun: Path | None = None

    def check(self) -> None:
        """Raise for what plainly cannot be written, before any frame is read."""
        if self.rows:
            row_writer(self.rows)
        if self.overlay and self.overlay.suffix.lower() not in CODECS:
            raise BadParameter("--overlay", str(self.overlay), f"named *{', *'.join(CODECS)}")
        if self.rerun:
            from vision_robot_cli.track_rerun import check_rerun

            check_rerun()
        for path in (self.rows, self.overlay, self.report, self.rerun):
            if path:
                check_place(path)


@dataclass
class Run:
    """A session on its way; `interrupted` and `failure` tell how it ended."""

    session: Session
    outputs: Outputs
    history: History = field(default_factory=History)
    first: Image | None = None
    interrupted: bool = False
    failure: BadInput | None = None

    def go(self, source: Source, fps: float, tick: Callable[[int, int], None], total: int | None) -> None:
        """All frames, or until Ctrl-C; every row seen so far is written in any case."""
        out = self.outputs
        with ExitStack() as stack:
            writers = [stack.enter_context(row_writer(out.rows))] if out.rows else []
            sinks: list[Callable[[Step], None]] = []
            try:
                for step in self.session.run(source):
                    if self.first is None:
                        self.first = step.frame.image.copy()
                        sinks = self._sinks(stack, fps)
                    for writer in writers:
                        writer.write(step.final)
                    self.history.add(step.final)
                    for sink in sinks:
                        sink(step)
                    tick(self.session.frames, total or self.session.frames)
            except KeyboardInterrupt:
                self.interrupted = True
            except BadInput as error:
                if self.first is None:
                    raise
                self.failure = error
            rest = self.session.rest()
            for writer in writers:
                writer.write(rest)
            self.history.add(rest)

    def summary(self) -> dict[str, Any]:
        """The object of --json."""
        session, out = self.session, self.outputs
        files = {"rows": out.rows, "overlay": out.overlay, "report": out.report, "rerun": out.rerun}
        return {
            "tracker": session.tracker.name,
            "frames": session.frames,
            "objects": session.objects,
            "rows": self.history.rows,
            "ms_per_frame": {
                "p50": session.latency.quantile_ms(0.5),
                "p99": session.latency.quantile_ms(0.99),
            },
            "out": str(out.rows) if out.rows else None,
            "files": {name: str(path) for name, path in files.items() if path},
            "figures": session.tracker.figures(),
            "remarks": [{"tone": tone, "text": text} for tone, text in session.remarks()],
            "camera_shift_px": session.camera.largest_px,
            "interrupted": self.interrupted,
            "ended_by": str(self.failure) if self.failure else None,
        }

    def text(self) -> str:
        """The same for a person."""
        session = self.session
        p50, p99 = session.latency.quantile_ms(0.5), session.latency.quantile_ms(0.99)
        lines = [
            f"{session.frames} frames, {session.objects} objects, {self.history.rows} rows",
            f"{p50:.1f} ms a frame ({p99:.1f} ms at the 99th percentile)",
            *(f"- {text}" for _, text in session.remarks()),
        ]
        if self.interrupted:
            lines.append("- interrupted: everything up to here is written")
        return "\n".join(lines)

    def write_report(self, source: str) -> None:
        """--report."""
        from vision_robot.report.page import write_page
        from vision_robot.report.tracks import tracks_page

        if not self.outputs.report or self.first is None:
            return
        page = tracks_page(
            self.session, self.history, self.first, source, command=shlex.join(["vr", *sys.argv[1:]])
        )
        write_page(page, self.outputs.report)
        note(f"report written to {self.outputs.report}")

    def _sinks(self, stack: ExitStack, fps: float) -> list[Callable[[Step], None]]:
        sinks: list[Callable[[Step], None]] = []
        assert self.first is not None
        if self.outputs.overlay:
            size = (self.first.shape[1], self.first.shape[0])
            video = _Kept(VideoWriter(self.outputs.overlay, size, fps))
            stack.enter_context(video)
            overlay = Overlay()
            sinks.append(lambda step: video.writer.write(self._drawn(overlay, step)))
        if self.outputs.rerun:
            from vision_robot_cli.track_rerun import rerun_sink

            sink = rerun_sink(self.outputs.rerun, lambda: self.session.tracker.mask)
            sinks.append(stack.enter_context(sink))
        return sinks

    def _drawn(self, overlay: Overlay, step: Step) -> Image:
        from vision_robot.track.admission import Admission

        image = Admission().converted(step.frame.image)
        return overlay.draw(image, self.session.tracker.mask, step.now, step.placed)


class _Kept:
    """A video that is kept however its with block ends: frames before an interrupt are worth having."""

    def __init__(self, writer: VideoWriter):
        self.writer = writer

    def __enter__(self) -> "_Kept":
        self.writer.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self.writer.__exit__(None, None, None)
