"""Rigid transforms, lenses, cameras and the work plane; numpy only."""

from vision_robot.geometry.camera import Camera, pixel_grid
from vision_robot.geometry.camera_rig import CameraRig
from vision_robot.geometry.chain import SerialChain
from vision_robot.geometry.hand_eye import HandEye
from vision_robot.geometry.known_camera import KnownCamera
from vision_robot.geometry.lens import LENSES, Lens, lens_named
from vision_robot.geometry.plane import pixels_from_plane, plane_from_pixels, plane_homography
from vision_robot.geometry.se3 import SE3, rotation_exp, rotation_log, skew
from vision_robot.geometry.triangulate import Triangulated, triangulate
from vision_robot.geometry.undistort import resampling_map
from vision_robot.geometry.work_plane import WorkPlane

__all__ = [
    "LENSES",
    "SE3",
    "Camera",
    "HandEye",
    "CameraRig",
    "KnownCamera",
    "Lens",
    "SerialChain",
    "Triangulated",
    "WorkPlane",
    "lens_named",
    "pixel_grid",
    "pixels_from_plane",
    "plane_from_pixels",
    "plane_homography",
    "resampling_map",
    "rotation_exp",
    "rotation_log",
    "skew",
    "triangulate",
]
