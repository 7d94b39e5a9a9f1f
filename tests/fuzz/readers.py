"""Every reader of the project with good inputs, which our own writers make where there are any."""

import json
import struct
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np

from tests.fuzz.subject import Subject
from tests.views import CAMERAS, make_views
from vision_robot.arm import read_arm
from vision_robot.arm.stream import JointTable
from vision_robot.errors import VisionRobotError
from vision_robot.geometry import SE3, Camera, CameraRig, HandEye, KnownCamera, WorkPlane
from vision_robot.tracks import Tracks

__all__ = ["GOALS_CSV", "POSE", "POSES_CSV", "SMALL", "SUBJECTS", "picture"]

RNG = np.random.default_rng(0)
SMALL = Camera(64, 48, 60.0, 61.0, 31.0, 24.0, 0.0, "brown5", (-0.1, 0.02, 1e-3, -1e-3, 0.0))
POSE = SE3.from_rotvec(np.array([3.0, 0.1, 0.05]), np.array([0.01, -0.02, 0.5]))


def picture(seed: int = 0, size: tuple[int, int] = (64, 48)) -> np.ndarray:
    x, y = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    smooth = 120 + 60 * np.sin(x / 7 + seed) + 50 * np.cos(y / 5)
    return np.stack([smooth, 240 - smooth, 255 - smooth], axis=-1).astype(np.uint8)


def _files(**contents: str | bytes) -> Callable[[Path], Sequence[Path]]:
    """A maker of one folder per given content; names are number_suffix."""

    def make(folder: Path) -> Sequence[Path]:
        made = []
        for name, content in contents.items():
            number, _, suffix = name.partition("_")
            place = folder / number
            place.mkdir()
            data = content.encode() if isinstance(content, str) else content
            (place / f"file.{suffix}").write_bytes(data)
            made.append(place)
        return made

    return make


def _written(name: str, *writes: Callable[[Path], object]) -> Callable[[Path], Sequence[Path]]:
    """A maker of one folder a writer, each with one file of that name."""

    def make(folder: Path) -> Sequence[Path]:
        made = []
        for i, write in enumerate(writes):
            place = folder / str(i)
            place.mkdir()
            write(place / name)
            made.append(place)
        return made

    return make


def _only(folder: Path) -> Path:
    (file,) = folder.iterdir()
    return file


# Cameras, rigs, planes.


def _camera(suffix: str, format: str | None = None, models: Sequence[str] = tuple(CAMERAS)) -> Subject:  # noqa: A002
    from vision_robot.formats import read_cameras, read_known_camera, write_camera

    def writer(camera: Camera) -> Callable[[Path], object]:
        return lambda path: write_camera(camera, path, format, allow_loss=True)

    def read(folder: Path) -> object:
        for camera in read_cameras(_only(folder)).values():
            camera.project(np.array([[0.1, 0.2, 1.0]]))
        return read_known_camera(_only(folder))

    make = _written(f"camera{suffix}", *(writer(CAMERAS[model]) for model in models))
    return Subject(f"camera {format or ''}{suffix}", make, read)


def _camera_with_covariance() -> Subject:
    from vision_robot.formats import read_known_camera, write_known_camera

    known = KnownCamera(SMALL, np.diag(np.full(10, 1e-4)))
    make = _written("camera.json", lambda path: write_known_camera(known, path))
    return Subject("camera with covariance", make, lambda folder: read_known_camera(_only(folder)))


def _rig_of(count: int) -> CameraRig:
    poses = SE3.from_rotvec(0.1 * RNG.normal(size=(count, 3)), RNG.normal(size=(count, 3)))
    return CameraRig.exact(tuple(f"cam{i}" for i in range(count)), (SMALL,) * count, poses)


def _rig(suffix: str) -> Subject:
    from vision_robot.formats.rig import holds_rig, read_rig, write_rig

    def read(folder: Path) -> object:
        holds_rig(_only(folder))
        return read_rig([_only(folder)])

    writes = [lambda path, n=n: write_rig(_rig_of(n), path, allow_loss=True) for n in (2, 3)]
    return Subject(f"rig {suffix}", _written(f"rig{suffix}", *writes), read)


def _hand_eye() -> Subject:
    from vision_robot.formats.hand_eye import corrected_chain, read_hand_eye, write_hand_eye

    chain = read_arm("column").chain
    found = HandEye("eye-in-hand", SMALL, POSE, POSE.inverse(), np.diag(np.full(12, 1e-6)), 1e-4, 1e-4)

    def read(folder: Path) -> object:
        read_hand_eye(_only(folder))
        return corrected_chain(_only(folder), chain)

    return Subject(
        "hand-eye file", _written("hand_eye.json", lambda p: write_hand_eye(found, p, chain)), read
    )


def _plane() -> Subject:
    from vision_robot.formats.work_plane import read_work_plane, write_work_plane

    plane = WorkPlane(SMALL, POSE, np.diag(np.full(16, 1e-6)))

    def read(folder: Path) -> object:
        return read_work_plane(_only(folder)).pixels(np.zeros((1, 2)))

    exact = WorkPlane.exact(SMALL, POSE)
    writes = [lambda p: write_work_plane(plane, p), lambda p: write_work_plane(exact, p)]
    return Subject("plane file", _written("plane.json", *writes), read)


# Poses, points, tables.

POSES_CSV = (
    "image,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0.png,100,0,200,1,0,0,0\n1.png,110,5,210,0.7071068,0.7071068,0,0\n"
    "2.png,90,-5,190,0.7071068,0,0.7071068,0\n"
)
POSES_EULER = "x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg,d1_mm\n0.1,0,0.2,10,20,30,4\n0.2,0,0.2,-10,0,170,5\n"
POSES_TUM = "# time x y z qx qy qz qw\n0.0 0.1 0.2 0.3 0 0 0 1\n0.1 0.1 0.2 0.3 0 0 1 0\n"
POSES_JSON = json.dumps(
    {
        "poses": [
            {
                "image": "0.png",
                "base_from_wrist": {"translation_m": [0.1, 0.2, 0.3], "rotvec_rad": [0, 0, 1]},
            },
            {
                "image": "1.png",
                "base_from_wrist": {"translation_m": [0.1, 0.2, 0.3], "rotvec_rad": [0, 1, 0]},
            },
        ]
    }
)
POSES_MATRIX = json.dumps([np.eye(4).tolist(), np.diag([1.0, -1, -1, 1]).tolist()])
GOALS_CSV = "# places\nx_mm,y_mm,z_mm,yaw_deg\n350,100,150,30\n300,-100,150,0\n"


def _poses() -> Subject:
    from vision_robot.calibrate.hand_eye.pose_file import read_poses

    def read(folder: Path) -> object:
        table = read_poses(_only(folder))
        return table.base_from_wrist if table.has_poses else table.joint_values(read_arm("column").chain)

    texts = {
        "0_csv": POSES_CSV,
        "1_csv": POSES_EULER,
        "2_txt": POSES_TUM,
        "3_json": POSES_JSON,
        "4_json": POSES_MATRIX,
    }
    joints = "d1_mm,theta2_deg,theta3_deg,theta4_deg,theta5_deg\n100,10,20,30,40\n"
    return Subject("poses", _files(**texts, **{"5_csv": joints}), read)


def _goals() -> Subject:
    from vision_robot_cli.goal_file import read_goals

    places = json.dumps([{"x_mm": 350, "y_mm": 100, "z_mm": 150, "yaw_deg": 30}])
    texts = {"0_csv": GOALS_CSV, "1_json": places, "2_csv": POSES_CSV, "3_json": POSES_JSON}
    return Subject("goals", _files(**texts), lambda folder: read_goals(_only(folder)))


def _corners() -> Subject:
    from vision_robot.calibrate.corner_files import read_corner_folder, read_model_points, size_holding

    def make(folder: Path) -> Sequence[Path]:
        views = make_views(CAMERAS["pinhole"], 3)
        place = folder / "0"
        (place / "views").mkdir(parents=True)
        np.savetxt(place / "model.txt", views.board[:20, :2])
        for i, view in enumerate(views.corners):
            np.savetxt(place / "views" / f"{i}.txt", view.pixels[:20])
        return [place]

    def read(folder: Path) -> object:
        return size_holding(
            read_corner_folder(folder / "views", len(read_model_points(folder / "model.txt")))
        )

    return Subject("corner lists", make, read)


def _marked() -> Subject:
    from vision_robot.extrinsics.marked_points import read_marked_points

    text = "u_px,v_px,x_mm,y_mm,sigma_px\n10,20,0,0,0.5\n30,20,100,0,0.5\n30,40,100,100,1\n10,40,0,100,1\n"
    return Subject(
        "marked points", _files(**{"0_csv": text}), lambda folder: read_marked_points(_only(folder))
    )


def _tracks_table() -> Tracks:
    n = 12
    frame, ids = np.repeat(np.arange(6), 2), np.tile([1, 2], 6)
    pairs, box = RNG.uniform(0, 40, (n, 2)), RNG.uniform(1, 20, (n, 4))
    return Tracks(frame, frame / 25, ids, pairs, box, box[:, 2], box[:, 2:], pairs[:, 0], pairs, pairs)


def _tracks() -> Subject:
    def read(folder: Path) -> object:
        return Tracks.read(_only(folder)).to_csv()

    return Subject("tracks", _written("tracks.csv", lambda p: _tracks_table().write(p)), read)


def _joints() -> Subject:
    chain = read_arm("column").chain
    middle = chain.limits.mean(axis=1)
    table = JointTable.of(chain, np.array([0.0, 0.5, 1.0]), np.tile(middle, (3, 1)))

    def read(folder: Path) -> object:
        found = JointTable.read(_only(folder), chain)
        found.check(chain)
        return found

    return Subject("joint table", _written("joints.csv", table.write), read)


def _stream_poses() -> Subject:
    from vision_robot_cli.stream_table import longest_step_s, poses

    timed = "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0.3,0,0.2,0,1,0,0\n0.5,0.3,0.1,0.2,0,1,0,0\n"
    return Subject(
        "poses to stream",
        _files(**{"0_csv": timed, "1_csv": POSES_CSV, "2_json": POSES_JSON}),
        lambda folder: longest_step_s(poses(_only(folder), None, 0.1)),
    )


# Recipes, options, arms.


def _recipe() -> Subject:
    from vision_robot_synth.recipe import read_recipe
    from vision_robot_synth.recipe.read import RECIPES

    own = """extend = "base"
description = "rods"
frames = 4
size = [64, 48]
[things.rod]
shape = "rod"
count = [1, 3]
colour = ["red", "#00ff00"]
[sensor]
read_noise = [1.0, 2.0]
[severity]
"things.rod.speed_mm_s" = [0, 100]
"""

    def make(folder: Path) -> Sequence[Path]:
        made = []
        for name in ("single-rod", "conveyor", "gripper-approach", "many-objects", "calibration"):
            (folder / name).mkdir()
            (folder / name / "recipe.toml").write_bytes((RECIPES / f"{name}.toml").read_bytes())
            made.append(folder / name)
        (folder / "own").mkdir()
        (folder / "own" / "recipe.toml").write_text(own)
        return [*made, folder / "own"]

    def read(folder: Path) -> object:
        recipe = read_recipe(folder / "recipe.toml").at(0.5)
        parts = (
            recipe.video,
            recipe.camera,
            recipe.table,
            recipe.light,
            recipe.arm,
            recipe.belt,
            recipe.truth,
        )
        return parts, recipe.board, recipe.things, recipe.sensor(0)

    return Subject("recipe", make, read)


def _scene() -> Subject:
    from vision_robot_synth.recipe import read_recipe
    from vision_robot_synth.scene.scene import scene_of

    inner = _recipe()

    def read(folder: Path) -> object:
        recipe = read_recipe(folder / "recipe.toml")
        return scene_of(recipe.at(0.5), 0) if recipe.video.kind == "video" else None

    return Subject("recipe to scene", inner.make, read)


def _tracker_options() -> Subject:
    from vision_robot_cli.track_input import tracker_of

    text = '[rgb]\ncolor = "red"\n[background]\nhistory = 50\n'
    return Subject(
        "tracker options", _files(**{"0_toml": text}), lambda folder: tracker_of("rgb", (), _only(folder))
    )


URDF = """<?xml version="1.0"?>
<robot name="two"><link name="base"/><link name="one"/><link name="hand"/><link name="tool"/>
<joint name="lift" type="prismatic"><parent link="base"/><child link="one"/>
<origin xyz="0 0 0.1" rpy="0 0 0.3"/><axis xyz="0 0 1"/>
<limit lower="0" upper="0.4" effort="1" velocity="1"/></joint>
<joint name="turn" type="revolute"><parent link="one"/><child link="hand"/>
<origin xyz="0.2 0 0"/><axis xyz="0 0 1"/><limit lower="-2" upper="2"/></joint>
<joint name="fix" type="fixed"><parent link="hand"/><child link="tool"/><origin xyz="0.1 0 0"/></joint>
</robot>
"""
MJCF = """<mujoco model="two"><compiler angle="degree"/><default><joint damping="1"/></default>
<worldbody><body name="one" pos="0 0 .1">
<joint name="lift" type="slide" axis="0 0 1" range="0 .4" limited="true"/><geom type="box" size=".1 .1 .1"/>
<body name="two" pos=".2 0 0" euler="0 0 10"><joint name="turn" axis="0 0 1" range="-90 90" limited="true"/>
<geom size=".05"/><site name="wrist"/><site name="tool" pos=".1 0 0"/></body></body>
</worldbody><equality/><actuator><position joint="turn" kp="10"/></actuator></mujoco>
"""


def _arm(name: str, text: str, suffix: str) -> Subject:
    def make(folder: Path) -> Sequence[Path]:
        made = _files(**{f"0_{suffix}": text})(folder)
        if suffix == "xml":
            from importlib.resources import files

            (folder / "1").mkdir()
            data = (files("vision_robot.arm") / "models" / "column_arm.xml").read_bytes()
            (folder / "1" / "file.xml").write_bytes(data)
            made = [*made, folder / "1"]
        return made

    def read(folder: Path) -> object:
        chain = read_arm(_only(folder)).chain
        return chain.base_from_tool(chain.limits.mean(axis=1))

    return Subject(f"arm {name}", make, read)


# Datasets.


def _dataset() -> Subject:
    from vision_robot.dataset import open_dataset
    from vision_robot.dataset.flow_files import FlowField, write_flow
    from vision_robot.dataset.mask_files import encode_ids
    from vision_robot.formats.native import camera_object
    from vision_robot.formats.pose import pose_object

    def make(folder: Path) -> Sequence[Path]:
        place = folder / "0"
        for name in ("frames", "truth/flow", "truth/masks"):
            (place / name).mkdir(parents=True)
        for i in range(3):
            cv2.imwrite(str(place / f"frames/{i:06d}.png"), picture(i))
            (place / f"truth/masks/{i:06d}.png").write_bytes(encode_ids(np.eye(48, 64, dtype=np.int64)))
        for i in range(2):
            flow = FlowField(np.ones((48, 64, 2), np.float32), np.zeros((48, 64), bool))
            write_flow(flow, place / f"truth/flow/{i:06d}.png")
        _tracks_table().rows(np.arange(6)).write(place / "truth/tracks.csv")
        motion = "frame,wx_rad,wy_rad,wz_rad,tx_m,ty_m,tz_m\n" + "0,3,0,0,0,0,0.5\n" * 3
        (place / "truth/camera.csv").write_text(motion)
        described = {
            "schema": "vr.dataset/1", "recipe": "made", "size": [64, 48], "fps": 25.0,
            "frames": {"pattern": "frames/{:06d}.png", "count": 3}, "camera": camera_object(SMALL),
            "cam_from_station": pose_object(POSE), "camera_motion": "truth/camera.csv",
            "objects": [{"id": 1, "name": "rod", "shape": "box"}],
            "truth": {
                "tracks": "truth/tracks.csv", "masks": {"pattern": "truth/masks/{:06d}.png"},
                "flow": {"pattern": "truth/flow/{:06d}.png", "step": 1},
            },
        }  # fmt: skip
        (place / "dataset.json").write_text(json.dumps(described))
        views = {key: described[key] for key in ("schema", "recipe", "camera")}
        (folder / "1/frames").mkdir(parents=True)
        cv2.imwrite(str(folder / "1/frames/0.png"), picture())
        (folder / "1/dataset.json").write_text(json.dumps({**views, "views": [{"image": "frames/0.png"}]}))
        return [place, folder / "1"]

    return Subject("dataset of ours", make, lambda folder: _walk(open_dataset(folder)))


def _walk(dataset) -> None:
    for frame in dataset.frames():
        dataset.flow(frame.index)
        dataset.masks(frame.index)
        dataset.plane(frame.index)


def _mot() -> Subject:
    from vision_robot.dataset import open_dataset

    gt = "1,1,30.0,4.0,3.0,2.0,1,1,1.0\n2,1,30.5,4.0,3.0,2.0,1,1,0.5\n2,7,11,12,4,3,0,8,1\n"
    info = "[Sequence]\nname=street\nimDir=img1\nframeRate=25\nseqLength=2\nimWidth=64\nimHeight=48\n"

    def make(folder: Path) -> Sequence[Path]:
        place = folder / "0"
        (place / "gt").mkdir(parents=True)
        (place / "img1").mkdir()
        (place / "gt/gt.txt").write_text(gt)
        (place / "seqinfo.ini").write_text(info)
        for i in (1, 2):
            cv2.imwrite(str(place / f"img1/{i:06d}.png"), picture(i))
        return [place]

    return Subject("dataset MOTChallenge", make, lambda folder: _walk(open_dataset(folder)))


def _otb() -> Subject:
    from vision_robot.dataset import open_dataset

    def make(folder: Path) -> Sequence[Path]:
        place = folder / "0"
        (place / "img").mkdir(parents=True)
        (place / "groundtruth_rect.txt").write_text("10,20\t5 6\n11,20,5,6\n0,0,0,0\n")
        for i in (1, 2, 3):
            cv2.imwrite(str(place / f"img/{i:04d}.png"), picture(i))
        return [place]

    return Subject("dataset OTB", make, lambda folder: _walk(open_dataset(folder)))


def _middlebury() -> Subject:
    from vision_robot.dataset import open_dataset
    from vision_robot.dataset.flow_files import FlowField, write_flow

    def make(folder: Path) -> Sequence[Path]:
        place = folder / "0"
        place.mkdir()
        for i in (10, 11):
            cv2.imwrite(str(place / f"frame{i}.png"), picture(i))
        write_flow(
            FlowField(np.ones((48, 64, 2), np.float32), np.zeros((48, 64), bool)), place / "flow10.flo"
        )
        return [place]

    return Subject("dataset Middlebury", make, lambda folder: _walk(open_dataset(folder)))


def _flow(suffix: str) -> Subject:
    from vision_robot.dataset.flow_files import FlowField, read_flow, write_flow

    flow = RNG.normal(size=(12, 16, 2)).astype(np.float32)
    flow[0, 0] = np.nan
    field = FlowField(flow, np.zeros((12, 16), dtype=bool))
    make = _written(f"flow{suffix}", lambda path: write_flow(field, path))
    return Subject(f"flow {suffix}", make, lambda folder: read_flow(_only(folder)).known)


def _ids() -> Subject:
    from vision_robot.dataset.mask_files import encode_ids, read_ids

    pictures = [np.eye(12, 16, dtype=np.int64), 300 * np.eye(12, 16, dtype=np.int64)]
    writes = [lambda path, ids=ids: path.write_bytes(encode_ids(ids)) for ids in pictures]
    return Subject("masks", _written("ids.png", *writes), lambda folder: read_ids(_only(folder)))


def _note() -> Subject:
    from tests.fuzz.notes import frame_note
    from vision_robot_synth.making.frame_files import Workshop

    return Subject(
        "note of a frame",
        _written("000000", lambda path: path.write_bytes(frame_note().to_bytes())),
        lambda folder: Workshop(folder, folder).note(0),
    )


# Pictures and videos.


def _image(suffix: str, samples: np.ndarray | None = None) -> Subject:
    from vision_robot.images import read_image

    given = [picture()] if samples is None else [samples]
    if suffix == ".png" and samples is None:
        given += [picture()[..., 0], np.dstack([picture(), picture()[..., :1]])]

    def write(given: np.ndarray) -> Callable[[Path], object]:
        return lambda path: path.write_bytes(cv2.imencode(suffix, given)[1].tobytes())

    name = f"picture {suffix}" + ("" if samples is None else " 16 bits")
    return Subject(name, _written(f"a{suffix}", *map(write, given)), lambda folder: read_image(_only(folder)))


def _video(suffix: str) -> Subject:
    from vision_robot.images import open_images
    from vision_robot.video import Video, VideoWriter

    def write(path: Path) -> None:
        with VideoWriter(path, (64, 48), 25) as writer:
            for i in range(8):
                writer.write(picture(i))

    def read(folder: Path) -> object:
        for frame in Video(_only(folder)):
            frame.image.sum()
        return [picture.sum() for picture in open_images([_only(folder)]).values()]

    return Subject(f"video {suffix}", _written(f"v{suffix}", write), read)


# The serial line.


class Wire:
    """A port on which a file arrives and nothing leaves."""

    name = "wire"

    def __init__(self, data: bytes):
        self._pieces = [data[i : i + 7] for i in range(0, len(data), 7)]

    def read(self, timeout_s: float) -> bytes:
        return self._pieces.pop(0) if self._pieces else b""

    def write(self, data: bytes) -> None:
        pass


def _line() -> Subject:
    import vision_robot.arm.stream.link as link_module
    from vision_robot.arm.stream.frame import Frame
    from vision_robot.arm.stream.link import Link
    from vision_robot.arm.stream.messages import VERSION, Kind

    welcome = struct.pack("<BBBI5f", 0, VERSION, 5, 77, *range(5))
    answer = struct.pack("<B7f", 0, *range(7))
    frames = [Frame(Kind.WELCOME, 9, 0, welcome), *(Frame(Kind.ANSWER, 9, k, answer) for k in (1, 2))]
    data = b"".join(frame.encode() for frame in frames)

    def read(folder: Path) -> object:
        link = Link(Wire(_only(folder).read_bytes()), 5, 77, timeout_s=1e-3, tries=1)
        before = link_module.secrets.randbelow
        link_module.secrets.randbelow = lambda most: 8  # type: ignore[assignment]
        try:
            link.open()
            return [link.move(k / 10, np.zeros(5)) for k in range(2)]
        finally:
            link_module.secrets.randbelow = before

    return Subject("serial line", _files(**{"0_bin": data}), read, ends=(VisionRobotError,))


# Results of benchmarks.


def _scores() -> Subject:
    from vision_robot.evaluate.baseline import regressions
    from vision_robot.evaluate.score import read_scores

    score = {
        "suite": "calibration", "scene": "usual", "method": "vr", "metric": "corner_error_px", "value": 0.02,
        "low": 0.01, "high": 0.03, "unit": "px", "better": "lower", "n": 10,
    }  # fmt: skip
    text = json.dumps(
        {"schema": "vr.benchmark/1", "scores": [score, {**score, "method": "cv2", "low": None}]}
    )

    def read(folder: Path) -> object:
        found = read_scores(_only(folder))
        return regressions(found, found)

    return Subject("baseline", _files(**{"0_json": text}), read)


def _outcomes() -> Subject:
    from vision_robot.evaluate.score import scores
    from vision_robot.evaluate.sweep import Cell, Outcome, Store

    cell = Cell("calibration", "usual", "vr", 0, "m:f", {"views": 4})

    def make(folder: Path) -> Sequence[Path]:
        (folder / "0").mkdir()
        Store(folder / "0").keep(Outcome(cell, {"corner_error_px": 0.1, "fps": float("nan")}, None, 0.1, 1))
        return [folder / "0"]

    def read(folder: Path) -> object:
        store = Store(folder)
        found = store.find(cell)
        return scores([found] if found else []), scores(list(store))

    return Subject("outcome of a sweep", make, read)


SUBJECTS = {
    subject.name: subject
    for subject in (
        _camera(".json"),
        _camera(".yaml", "opencv"),
        _camera(".json", "opencv"),
        _camera(".xml", "opencv"),
        _camera(".yaml", "ros"),
        _camera(".yaml", "kalibr", ("pinhole", "brown5", "fisheye")),
        _camera(".txt", "colmap"),
        _camera(".cameramodel", "mrcal", ("pinhole", "brown5", "brown8")),
        _camera(".m", "matlab", ("pinhole", "brown5")),
        _camera(".json", "matlab", ("pinhole", "brown5")),
        _camera(".mat", "matlab", ("pinhole", "brown5")),
        _camera_with_covariance(),
        _rig(".json"),
        _rig(".yaml"),
        _hand_eye(),
        _plane(),
        _poses(),
        _goals(),
        _corners(),
        _marked(),
        _tracks(),
        _joints(),
        _stream_poses(),
        _recipe(),
        _scene(),
        _tracker_options(),
        _arm("URDF", URDF, "urdf"),
        _arm("MJCF", MJCF, "xml"),
        _dataset(),
        _mot(),
        _otb(),
        _middlebury(),
        _flow(".flo"),
        _flow(".png"),
        _ids(),
        _note(),
        *(_image(suffix) for suffix in (".png", ".jpg", ".tif", ".bmp", ".webp", ".jp2", ".ppm")),
        _image(".png", picture().astype(np.uint16) * 200),
        *(_video(suffix) for suffix in (".avi", ".mp4", ".mkv", ".webm")),
        _line(),
        _scores(),
        _outcomes(),
    )
}
"""Name -> what is fuzzed."""
