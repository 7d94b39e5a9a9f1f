"""A folder in which the examples of the help can be run as they stand."""

from pathlib import Path

import cv2
import numpy as np

from tests.chessboard_pictures import CAMERA, picture, posed
from tests.track.scenes import SIZE, moving, rendered
from vision_robot.calibrate.boards import Chessboard
from vision_robot.formats import write_camera
from vision_robot.formats.work_plane import write_work_plane
from vision_robot.geometry import SE3, Camera
from vision_robot.geometry.work_plane import WorkPlane
from vision_robot.video import VideoWriter

ARM = Path(__file__).parents[2] / "vision_robot/arm/models/column_arm.xml"


def furnish(folder: Path) -> None:
    """Photos of a board, files of camera and plane, a video, an arm, tables; named as in the examples."""
    board = Chessboard(9, 6, 0.025)
    (folder / "photos").mkdir()
    for index in range(5):
        pose = posed(index, tilt_deg=(20, 40), distance_m=0.45, board=board)
        photo = picture(pose, board=board).grey
        cv2.imwrite(str(folder / "photos" / f"{index}.jpg"), photo, [cv2.IMWRITE_JPEG_QUALITY, 99])
    (folder / "table").mkdir()
    (folder / "table/0.jpg").write_bytes((folder / "photos/0.jpg").read_bytes())
    write_camera(CAMERA, folder / "camera.json")
    write_camera(Camera(480, 360, 420, 418, 241.3, 176.7), folder / "camchain.yaml", "kalibr")
    down = SE3.from_rotvec(np.array([3.0, 0.1, 0]), np.array([0, 0, 0.5]))
    write_work_plane(WorkPlane.exact(Camera(1280, 960, 1000, 1000, 640, 480), down), folder / "plane.json")
    frames = rendered(moving, 40)
    with VideoWriter(folder / "belt.mp4", SIZE, 25) as video:
        for frame in frames:
            video.write(frame)
    cv2.imwrite(str(folder / "frame.png"), cv2.resize(frames[0], (640, 480)))
    (folder / "my_arm.xml").write_bytes(ARM.read_bytes())
    (folder / "goals.csv").write_text("x_mm,y_mm,z_mm,yaw_deg\n350,100,150,30\n300,-80,150,0\n")
    (folder / "moves.csv").write_text(
        "time_s,d1_mm,theta2_deg,theta3_deg,theta4_deg,theta5_deg\n0,100,0,0,0,0\n1,120,10,-5,0,30\n"
    )
