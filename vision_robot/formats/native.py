"""Our own JSON: ``{"schema": "vr.camera/1", "camera": {...}, "covariance": {...}}``.

The objects are those that `vr calibrate --json` prints, so that whole output, saved to a
file, reads as well. The covariance may be missing: then nothing is known of the camera's error.
"""

import json
import re

from vision_robot.errors import BadParameter
from vision_robot.formats.camera_format import ALL_LENSES, CameraFormat
from vision_robot.formats.covariance import covariance_object, read_covariance
from vision_robot.formats.intrinsics import make_camera
from vision_robot.formats.parse import parse_json
from vision_robot.formats.source import CameraSource
from vision_robot.geometry import Camera, KnownCamera, lens_named

__all__ = ["FORMAT", "SCHEMA", "camera_object", "read_known", "write_known"]

SCHEMA = "vr.camera/1"


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


def read_known(source: CameraSource) -> KnownCamera:
    """The camera with its covariance, exact where the file has none."""
    (camera,) = read(source).values()
    known = parse_json(source).find("covariance")
    if known is None:
        return KnownCamera.exact(camera)
    return KnownCamera(camera, read_covariance(known, camera.parameter_names))


def camera_object(camera: Camera) -> dict[str, object]:
    """The `camera` object."""
    return {
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


def write(camera: Camera, suffix: str) -> bytes:  # noqa: ARG001
    """JSON, numbers with all their digits."""
    return write_known(KnownCamera.exact(camera))


def write_known(known: KnownCamera) -> bytes:
    """The same with the covariance, where there is one."""
    fields: dict[str, object] = {"schema": SCHEMA, "camera": camera_object(known.camera)}
    if not known.taken_as_exact:
        fields["covariance"] = covariance_object(known.camera.parameter_names, known.covariance)
    return (json.dumps(fields, indent=2) + "\n").encode()


FORMAT = CameraFormat("JSON of this tool", matches, read, write, ALL_LENSES, skew=True)
