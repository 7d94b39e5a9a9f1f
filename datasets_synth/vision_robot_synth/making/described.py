"""dataset.json: all that decides the bytes of a dataset, and where its files are."""

from importlib.metadata import version
from typing import Any

import cv2

import vision_robot
from vision_robot.dataset.generated import SCHEMA
from vision_robot.formats.native import camera_object
from vision_robot.formats.pose import pose_object
from vision_robot.sim.gl import choose_back_end
from vision_robot_synth.making.frame_files import FRAME, MASK, flow_pattern
from vision_robot_synth.scene.scene import Scene

__all__ = ["described"]


def described(scene: Scene, severity: float) -> dict[str, Any]:
    """The object of dataset.json. Raises MissingOpenGL where nothing can render."""
    video, truth = scene.recipe.video, scene.recipe.truth
    files: dict[str, Any] = {"tracks": "truth/tracks.csv", "mot": "gt/gt.txt"}
    if truth.masks:
        files["masks"] = {"pattern": MASK}
    if truth.coco:
        files["coco"] = "truth/masks.json"
    if truth.flow != "none":
        files["flow"] = {"pattern": flow_pattern(truth.flow), "step": truth.flow_step}
    moving = {"camera_motion": "truth/camera.csv"} if scene.shake else {}
    return {
        "schema": SCHEMA,
        "recipe": scene.recipe.name,
        "description": video.description,
        "severity": severity,
        "seed": scene.seed,
        "versions": {
            "vision_robot": vision_robot.__version__,
            **{name: version(name) for name in ("mujoco", "numpy")},
            "opencv": cv2.__version__,
        },
        "renderer": choose_back_end().renderer,
        "size": list(video.size),
        "fps": video.fps,
        "frames": {"pattern": FRAME, "count": video.frames},
        "camera": camera_object(scene.view.camera),
        "cam_from_station": pose_object(scene.view.cam_from_station),
        **moving,
        "objects": _objects(scene),
        "sensor": vars(scene.sensor),
        "truth": files,
        "values": scene.recipe.tree,
    }


def _objects(scene: Scene) -> list[dict[str, Any]]:
    objects = [
        {"name": item.name, "shape": item.shape, "size_m": list(item.size_m), "colour": list(item.colour)}
        for item in scene.design.items
        if item.tracked
    ]
    mount = scene.design.arm
    if mount is not None and mount.label is not None:
        size = [*mount.label_m]
        objects.append({"name": "label", "shape": "label", "size_m": size, "colour": list(mount.label)})
    return [{"id": k, **one} for k, one in enumerate(objects, start=1)]
