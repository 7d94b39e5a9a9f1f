"""The file of a work plane, our own JSON with the keys schema, camera, cam_from_station and covariance.

It reads as a camera file too; `vr extrinsics plane --json` prints the same keys among others.
"""

import json
from pathlib import Path

from vision_robot.files import write_text
from vision_robot.formats import native
from vision_robot.formats.covariance import covariance_object, read_covariance
from vision_robot.formats.parse import parse_json
from vision_robot.formats.pose import pose_object, read_pose
from vision_robot.formats.source import open_source
from vision_robot.geometry.work_plane import WorkPlane

__all__ = ["SCHEMA", "plane_object", "read_work_plane", "write_work_plane"]

SCHEMA = "vr.plane/1"


def plane_object(plane: WorkPlane) -> dict[str, object]:
    """The keys of the file, without its schema."""
    return {
        "camera": native.camera_object(plane.camera),
        "cam_from_station": pose_object(plane.cam_from_station),
        "covariance": covariance_object(plane.parameter_names, plane.covariance),
    }


def write_work_plane(plane: WorkPlane, path: Path | str) -> None:
    """Write the file, whole or not at all; reading it gives exactly the same numbers."""
    write_text(path, json.dumps({"schema": SCHEMA, **plane_object(plane)}, indent=1) + "\n")


def read_work_plane(path: Path | str) -> WorkPlane:
    """Read such a file; raises BadCameraFile, naming the key and what was expected there.

    A plane without `covariance` is taken as exact.
    """
    source = open_source(path)
    tree = parse_json(source)
    if tree.find("cam_from_station") is None:
        raise source.bad("cam_from_station is missing: give the file that 'vr extrinsics plane -o' wrote")
    (camera,) = native.read(source).values()
    plane = WorkPlane.exact(camera, read_pose(tree.get("cam_from_station")))
    known = tree.find("covariance")
    if known is None:
        return plane
    covariance = read_covariance(known, plane.parameter_names)
    return WorkPlane(camera, plane.cam_from_station, covariance)
