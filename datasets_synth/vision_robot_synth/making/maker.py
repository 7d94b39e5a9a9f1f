"""One process' share of a dataset: frames rendered, exposed, and written with their truth."""

from collections.abc import Iterator
from typing import Any, Self

import cv2
import numpy as np

from vision_robot.dataset.flow_files import FlowField, encode_flow
from vision_robot.dataset.mask_files import encode_ids, encode_runs
from vision_robot.sim.true_flow import true_flow
from vision_robot.sim.truth import TruthFrame, TruthRenderer
from vision_robot.types import Image
from vision_robot_synth.making.frame_files import FRAME, MASK, Workshop, flow_pattern
from vision_robot_synth.making.frame_note import FrameNote
from vision_robot_synth.scene.scene import Scene
from vision_robot_synth.scene.stage import Stage
from vision_robot_synth.sensor import mean_of

__all__ = ["Maker"]

FASTEST = [
    cv2.IMWRITE_PNG_STRATEGY,
    cv2.IMWRITE_PNG_STRATEGY_RLE,
    cv2.IMWRITE_PNG_FILTER,
    cv2.IMWRITE_PNG_FILTER_UP,
]
"""Noise has no repeats to look for: less than half the time of level 1, and 10 % smaller."""


class Maker:
    """Makes frames of a scene; holds its cell and its OpenGL context. Use it as a context manager."""

    def __init__(self, scene: Scene, workshop: Workshop):
        self._scene, self._workshop = scene, workshop
        self._truth = scene.recipe.truth
        self._count = scene.recipe.video.frames
        self._stage = Stage(scene)
        self._eye: TruthRenderer | None = None
        self._eye = self._renderer()

    def make(self, start: int, stop: int) -> Iterator[int]:
        """Make the frames `start` to before `stop`; gives the number of each that is done."""
        if start < self._stage.next_frame and not self._scene.is_planned:
            self.close()
            self._stage = Stage(self._scene)
            self._eye = self._renderer()
        step = self._truth.flow_step if self._truth.flow != "none" else 0
        waiting: dict[int, TruthFrame] = {}
        saved: Any = None
        for frame in range(start, min(stop + step, self._count)):
            if frame == stop:
                saved = self._stage.save()
            waiting[frame] = self._photograph(frame, delivered=frame < stop)
            if step and frame - step in waiting:
                before = waiting.pop(frame - step)
                flow = true_flow(before, waiting[frame])
                data = encode_flow(FlowField(flow.flow_px, flow.occluded), f".{self._truth.flow}")
                self._workshop.write(flow_pattern(self._truth.flow).format(frame - step), data)
                yield self._finished(frame - step, before)
            if frame < stop and (step == 0 or frame + step >= self._count):
                yield self._finished(frame, waiting[frame])
        if saved is not None:
            self._stage.back(saved)

    def close(self) -> None:
        """Free the OpenGL context."""
        if self._eye is not None:
            self._eye.close()
            self._eye = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _renderer(self) -> TruthRenderer:
        lens = self._scene.view.camera.model != "pinhole"
        # A lens is rendered larger and averaged down, which smooths outlines by itself.
        return TruthRenderer(
            self._stage.cell,
            self._scene.view,
            multisamples=0 if lens else 4,
            depth=self._truth.flow != "none",
        )

    def _photograph(self, frame: int, *, delivered: bool) -> TruthFrame:
        """The truth of a frame; its picture is written if it is `delivered` and not dropped."""
        scene, eye = self._scene, self._eye
        assert eye is not None, "open"
        wanted = delivered and scene.sensor.delivered(frame, scene.seed) == frame
        middle, exposures, truth = scene.exposures // 2, [], None
        for i, time in enumerate(self._stage.moments(frame)):
            # A camera that stands still need not draw again what cannot have changed.
            pose = scene.shake.cam_from_station(scene.view.cam_from_station, time) if scene.shake else None
            if i == middle:
                truth = eye.frame(pose)
                exposures.append(truth.image)
            elif wanted:
                exposures.append(eye.picture(pose))
        assert truth is not None, "the number of exposures is odd"
        if wanted:
            picture = scene.sensor.expose(
                mean_of(exposures), frame, frame / scene.recipe.video.fps, scene.seed
            )
            self._workshop.write(FRAME.format(frame), _png(picture))
        return truth

    def _finished(self, frame: int, truth: TruthFrame) -> int:
        ids = truth.ids
        if self._truth.masks:
            self._workshop.write(MASK.format(frame), encode_ids(ids))
        self._workshop.finish(frame, FrameNote(truth.objects, self._runs(ids, truth)))
        return frame

    def _runs(self, ids: Any, truth: TruthFrame) -> dict[int, list[int]]:
        if not self._truth.coco:
            return {}
        boxes = truth.objects.visible_box_px
        runs = {}
        for id_ in np.flatnonzero(np.isfinite(boxes[:, 0])) + 1:
            left, width = boxes[id_ - 1, 0], boxes[id_ - 1, 2]
            columns = slice(max(int(left) - 1, 0), int(np.ceil(left + width)) + 2)
            counts = encode_runs(ids == id_, columns)
            if len(counts) > 1:
                runs[int(id_)] = counts
        return runs


def _png(picture: Image) -> bytes:
    return cv2.imencode(".png", picture, FASTEST)[1].tobytes()
