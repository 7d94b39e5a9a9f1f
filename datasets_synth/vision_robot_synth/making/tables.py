"""The tables of a dataset, put together from the notes of its frames."""

import json
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from vision_robot.dataset.mot import mot_text, sequence_text
from vision_robot.sim.truth_tracks import truth_tracks
from vision_robot.tracks import Tracks
from vision_robot_synth.making.frame_files import FRAME
from vision_robot_synth.making.frame_note import FrameNote
from vision_robot_synth.scene.scene import Scene

__all__ = ["camera_table", "coco_text", "mot_table", "sequence_file", "tracks_of"]


def tracks_of(scene: Scene, notes: Sequence[FrameNote]) -> Tracks:
    """The truth of all frames as one table; `dropped` marks frames that repeat an earlier picture."""
    fps = scene.recipe.video.fps
    table = truth_tracks((i / fps, note.objects) for i, note in enumerate(notes))
    dropped = [float(scene.sensor.delivered(i, scene.seed) != i) for i in range(len(notes))]
    return replace(table, extra={**table.extra, "dropped": np.array(dropped)[table.frame]})


def mot_table(tracks: Tracks) -> str:
    """MOTChallenge's gt.txt: whole boxes, hidden parts included, of what is seen at least in part."""
    extra = tracks.extra
    names = ("amodal_left_px", "amodal_top_px", "amodal_width_px", "amodal_height_px")
    whole = replace(tracks, box_px=np.stack([extra[name] for name in names], axis=1))
    seen = extra["occluded"] < 1
    return mot_text(whole.rows(seen), 1 - extra["occluded"][seen])


def sequence_file(scene: Scene) -> str:
    """MOTChallenge's seqinfo.ini."""
    video = scene.recipe.video
    return sequence_text(scene.recipe.name, "frames", video.fps, video.frames, video.size, ".png")


def camera_table(scene: Scene) -> str:
    """Pose of the station before a camera that moves: cam_from_station of each frame."""
    lines = ["frame,wx_rad,wy_rad,wz_rad,tx_m,ty_m,tz_m"]
    for frame in range(scene.recipe.video.frames):
        pose = scene.cam_from_station(frame)
        numbers = [*pose.rotvec().tolist(), *pose.translation.tolist()]
        lines.append(f"{frame}," + ",".join(f"{number:.12g}" for number in numbers))
    return "\n".join(lines) + "\n"


def coco_text(scene: Scene, notes: Sequence[FrameNote]) -> str:
    """The masks as COCO keeps them; `track_id` is the id of the object."""
    width, height = scene.recipe.video.size
    images, annotations = [], []
    for i, note in enumerate(notes):
        images.append({"id": i, "file_name": FRAME.format(i), "width": width, "height": height})
        for id_, counts in note.runs.items():
            left, top, wide, high = np.round(note.objects.visible_box_px[id_ - 1], 3).tolist()
            annotations.append(
                {
                    "id": len(annotations) + 1,
                    "image_id": i,
                    "category_id": id_,
                    "track_id": id_,
                    # COCO's pixels have their left border at whole numbers.
                    "bbox": [left + 0.5, top + 0.5, wide, high],
                    "area": int(sum(counts[1::2])),
                    "iscrowd": 0,
                    "segmentation": {"size": [height, width], "counts": counts},
                }
            )
    names = notes[0].objects.names if notes else ()
    categories: list[dict[str, Any]] = [{"id": k, "name": name} for k, name in enumerate(names, start=1)]
    return json.dumps({"images": images, "annotations": annotations, "categories": categories}) + "\n"
