"""Our own JSON: ``{"schema": "vr.camera/1", "camera": {...}}``.

The `camera` object is the one `vr calibrate --json` prints, so that whole output, saved to a
file, reads as well.
"""

import json
import re

from vision_robot.errors import BadParameter
from vision_robot.formats.camera_format import ALL_LENSES, CameraFormat
from vision_robot.formats.intrinsics import make_camera
from vision_robot.formats.parse import parse_json
from vision_robot.formats.source import CameraSource
from vision_robot.geometry import Camera, lens_named

__all__ = ["FORMAT"]


def matches(source: CameraSource) -> bool:
    """A JSON object with our keys."""
    head = source.data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1]
    return head == b"{" and re.search(rb'"schema"\s*:\s*"vr\.|"fx"\s*:', source.data) is not None


def read(source: CameraSource) -> dict[str, Camera]:
    """The camera object, at the top or under `camera`."""
    top = parse_json(source)
    tree = top.find("camera") or top
    names = ("fx", "fy", "cx", "cy", "skew")
    fx, fy, cx, cy, skew = (tree.get(name).number() for name in names)
    model = tree.get("model")
    try:
        count = len(lens_named(model.text()).coefficient_names)
    except BadParameter as error:
        raise model.bad(str(error)) from error
    k = tree.get("distortion").numbers(count)
    size = (tree.get("width").whole(), tree.get("height").whole())
    return {"camera": make_camera(source, size, (fx, fy, cx, cy, skew), model.text(), k)}


def write(camera: Camera, suffix: str) -> bytes:  # noqa: ARG001
    """JSON, numbers with all their digits."""
    fields = {
        "width": camera.width,
        "height": camera.height,
        "fx": camera.fx,
        "fy": camera.fy,
        "cx": camera.cx,
        "cy": camera.cy,
        "skew": camera.skew,
        "model": camera.model,
        "distortion": list(camera.distortion),
    }
    return (json.dumps({"schema": "vr.camera/1", "camera": fields}, indent=2) + "\n").encode()


FORMAT = CameraFormat("JSON of this tool", matches, read, write, ALL_LENSES, skew=True)
