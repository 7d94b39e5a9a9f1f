"""Small files that ask for much time or memory, lead elsewhere or would run something.

As a script (`python -m tests.fuzz.bombs`) each is read in a process of its own, whose memory and time are
limited, and the answers are printed as JSON.
"""

import io
import json
import os
import shutil
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tests.fuzz.limits import apart
from tests.fuzz.readers import SUBJECTS
from tests.fuzz.subject import Case, Files, Subject, attempt

__all__ = ["BOMBS", "LIMIT_MB", "LIMIT_S"]

LIMIT_MB, LIMIT_S = 1500, 30

Content = bytes | Callable[[Path], object]
"""Of the file, or what puts something at its place."""


def _aliases(first: str, width: int, levels: int) -> bytes:
    lines = [f"a0: &a0 {first}"]
    for level in range(1, levels):
        lines.append(f"a{level}: &a{level} [{', '.join([f'*a{level - 1}'] * width)}]")
    return "\n".join(["%YAML 1.1", "---", *lines, f"camera_matrix: *a{levels - 1}", "D: [0]"]).encode()


def _laughs(inside: str) -> bytes:
    entities = '<!ENTITY a0 "ha">' + "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10}">' for k in range(1, 12))
    return f'<?xml version="1.0"?><!DOCTYPE x [{entities}]>{inside}'.encode()


def _png(width: int, height: int, rows: int) -> bytes:
    """A black picture whose header says width x height and whose data hold `rows` rows."""
    packer = zlib.compressobj(9)
    row = bytes(1 + (width + 7) // 8)
    data = b"".join(packer.compress(row) for _ in range(rows)) + packer.flush()

    def chunk(kind: bytes, content: bytes) -> bytes:
        check = struct.pack(">I", zlib.crc32(kind + content))
        return struct.pack(">I", len(content)) + kind + content + check

    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def _tiff(width: int, height: int) -> bytes:
    tags = [
        (256, 4, width), (257, 4, height), (258, 3, 8), (259, 3, 1), (262, 3, 1), (273, 4, 8), (277, 3, 1),
        (278, 4, height), (279, 4, 4),
    ]  # fmt: skip
    entries = b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags)
    return b"II*\0" + struct.pack("<I", 12) + b"\0" * 4 + struct.pack("<H", len(tags)) + entries + b"\0" * 4


def _jpeg(width: int, height: int) -> bytes:
    import cv2

    data = bytearray(cv2.imencode(".jpg", np.zeros((16, 16, 3), np.uint8))[1].tobytes())
    at = data.index(b"\xff\xc0")
    data[at + 5 : at + 9] = struct.pack(">HH", height, width)
    return bytes(data)


def _bmp(width: int, height: int) -> bytes:
    head = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, 0, 0, 0, 0, 0)
    return b"BM" + struct.pack("<IHHI", 54 + 64, 0, 0, 54) + head + bytes(64)


def _archive(shape: tuple[int, ...], dtype: str) -> bytes:
    """A .npz whose array says it is much larger than it is."""
    head = f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    held = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode()
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("rotation.npy", held + bytes(1_000_000))
    return archive.getvalue()


def _matfile() -> bytes:
    content = zlib.compress(struct.pack("<II", 14, 1_000_000_000) + bytes(400_000_000), 9)
    return (
        b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H2sII", 0x0100, b"IM", 15, len(content)) + content
    )


def _avi(width: int, height: int) -> Callable[[Path], object]:
    def make(path: Path) -> None:
        from vision_robot.video import VideoWriter

        with VideoWriter(path, (64, 48), 25) as writer:
            writer.write(np.zeros((48, 64), np.uint8))
        data = path.read_bytes().replace(struct.pack("<II", 64, 48), struct.pack("<II", width, height))
        path.write_bytes(data)

    return make


def _numbered(*names: str) -> Callable[[Path], object]:
    def make(path: Path) -> None:
        import cv2

        path.unlink(missing_ok=True)
        for name in names:
            cv2.imwrite(str(path.parent / name), np.zeros((8, 8), np.uint8))

    return make


def _arm(inside: str, before: str = "") -> bytes:
    body = f'<body><joint name="j" axis="0 0 1" range="-1 1" limited="true"/><geom size=".1"/>{inside}'
    return f'<mujoco>{before}<worldbody>{body}<site name="tool"/></body></worldbody></mujoco>'.encode()


def _described(**changes: object) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        good = SUBJECTS["dataset of ours"].seeds(Path(folder) / "seeds")[0]
    tree = json.loads(good["dataset.json"])
    for key, value in changes.items():
        *tables, name = key.split("__")
        place = tree
        for table in tables:
            place = place[table]
        place[name] = value
    return json.dumps(tree).encode()


def _linked(to: str) -> Callable[[Path], object]:
    return lambda path: path.symlink_to(to)


NESTED = b"[" * 5_000_000
PICKLE = b"cos\nsystem\n(S'touch pwned'\ntR."

BOMBS: dict[str, tuple[str, str, Content]] = {
    "YAML aliases of aliases": ("camera opencv.yaml", "camera.yaml", _aliases("[1, 1, 1]", 9, 12)),
    "YAML aliases of nothing": ("camera opencv.yaml", "camera.yaml", _aliases("[]", 1500, 4)),
    "YAML object": ("camera ros.yaml", "camera.yaml",
        b"camera_matrix: !!python/object/apply:os.system ['touch pwned']"),
    "YAML nested": ("camera opencv.yaml", "camera.yaml", b"camera_matrix: " + NESTED),
    "JSON nested": ("camera .json", "camera.json", b'{"fx": ' + NESTED),
    "JSON of lists": ("camera .json", "camera.json", b'{"fx": [' + b"[]," * 1_000_000 + b"1]}"),
    "XML entities": ("camera opencv.xml", "camera.xml",
        _laughs("<opencv_storage><a>&a11;</a></opencv_storage>")),
    "XML entities in a URDF": ("arm URDF", "file.urdf", _laughs("<robot>&a11;</robot>")),
    "XML entities in UTF-16": ("arm URDF", "file.urdf",
        _laughs("<robot>&a11;</robot>").decode().encode("utf-16")),
    "XML of a file elsewhere": ("arm URDF", "file.urdf",
        b'<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><robot name="&a;"/>'),
    "XML nested": ("arm URDF", "file.urdf", b"<a>" * 1_000_000),
    "XML of an unknown encoding": ("arm URDF", "file.urdf",
        b'<?xml version="1.0" encoding="no-such"?><robot/>'),
    "brackets without end": ("camera matlab.m", "camera.m", b"K:[\n" * 1_000_000),
    "MAT-file of 400 MB": ("camera matlab.mat", "camera.mat", _matfile()),
    "mrcal code": ("camera mrcal.cameramodel", "camera.cameramodel",
        b"{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [__import__('os').system('touch pwned')]}"),
    "PNG of 2 500 megapixels": ("picture .png", "a.png", _png(50_000, 50_000, 50_000)),
    "PNG that claims 225 megapixels": ("picture .png", "a.png", _png(15_000, 15_000, 3)),
    "TIFF that claims 1 600 megapixels": ("picture .tif", "a.tif", _tiff(40_000, 40_000)),
    "JPEG that claims 4 290 megapixels": ("picture .jpg", "a.jpg", _jpeg(65_500, 65_500)),
    "JPEG that claims 225 megapixels": ("picture .jpg", "a.jpg", _jpeg(15_000, 15_000)),
    "BMP that claims 4 megameters": ("picture .bmp", "a.bmp", _bmp(2_000_000_000, 2_000_000_000)),
    "PPM that claims 3 600 megapixels": ("picture .ppm", "a.ppm", b"P6\n60000 60000\n255\n" + bytes(1000)),
    "flow that claims 80 GB": ("flow .flo", "flow.flo",
        b"PIEH" + struct.pack("<ii", 99_999, 99_999) + bytes(80)),
    "masks of 2 500 megapixels": ("masks", "ids.png", _png(50_000, 50_000, 10)),
    "video that claims 2 500 megapixels": ("video .avi", "v.avi", _avi(50_000, 50_000)),
    "video that is a playlist": ("video .mp4", "v.mp4",
        b"#EXTM3U\n#EXT-X-MEDIA-SEQUENCE:0\n#EXTINF:10.0,\n/etc/passwd\n#EXT-X-ENDLIST\n"),
    "archive that claims 80 GB": ("note of a frame", "000000", _archive((100_000, 100_000), "<f8")),
    "archive of objects": ("note of a frame", "000000", _archive((1,), "|O")),
    "archive that is a pickle": ("note of a frame", "000000", PICKLE),
    "dataset of 10^12 frames": ("dataset of ours", "dataset.json", _described(frames__count=10**12)),
    "dataset that leads elsewhere": ("dataset of ours", "dataset.json",
        _described(truth__tracks="../../etc/passwd")),
    "dataset of files elsewhere": ("dataset of ours", "dataset.json",
        _described(camera_motion="/etc/passwd")),
    "frames 1 and 10^18": ("dataset Middlebury", "frame10.png",
        _numbered("frame1.png", f"frame{10**18}.png")),
    "MJCF of 10^8 bodies": ("arm MJCF", "file.xml",
        _arm('<replicate count="100000000"><geom size=".1"/></replicate>')),
    "MJCF of 10^12 bodies": ("arm MJCF", "file.xml",
        _arm('<replicate count="1000">' * 4 + '<geom size=".1"/>' + "</replicate>" * 4)),
    "MJCF of 10^9 key frames": ("arm MJCF", "file.xml", _arm("", '<size nkey="1000000000"/>')),
    "MJCF of a field of 10^10": ("arm MJCF", "file.xml",
        _arm("", '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>')),
    "MJCF that includes itself": ("arm MJCF", "file.xml", b'<mujoco><include file="file.xml"/></mujoco>'),
    "MJCF that includes a device": ("arm MJCF", "file.xml", b'<mujoco><include file="/dev/zero"/></mujoco>'),
    "CSV field of 200 kB": ("tracks", "tracks.csv", b"frame,id,u_px,v_px\n1,1,2," + b"9" * 200_000),
    "CSV of 5 million empty lines": ("tracks", "tracks.csv", b"frame,id,u_px,v_px\n" + b"\n" * 5_000_000),
    "CSV of 5 million commas": ("tracks", "tracks.csv", b"frame,id,u_px,v_px\n" + b"," * 5_000_000),
    "poses of 5 million lines": ("poses", "file.csv", b"x,y,z,rx,ry,rz\n" + b"\n" * 5_000_000),
    "points of 1 million numbers": ("corner lists", "model.txt", b"1 " * 1_000_000),
    "TOML nested": ("recipe", "recipe.toml", b"a = " + b"[" * 900_000),
    "TOML of dots": ("recipe", "recipe.toml", b"a." * 400_000 + b"a = 1"),
    "TOML of fewer dots": ("recipe", "recipe.toml", b"a." * 19_000 + b"a = 1"),
    "TOML of a huge number": ("recipe", "recipe.toml", b"frames = " + b"9" * 900_000),
    "recipe of 10^12 frames": ("recipe to scene", "recipe.toml", b'extend = "base"\nframes = 1000000000000'),
    "recipe of a giant picture": ("recipe to scene", "recipe.toml",
        b'extend = "base"\nsize = [1000000, 1000000]'),
    "recipe that extends itself": ("recipe", "recipe.toml", b'extend = "recipe.toml"'),
    "a device for a camera": ("camera .json", "camera.json", _linked("/dev/zero")),
    "a device for a table": ("tracks", "tracks.csv", _linked("/dev/zero")),
    "a device for a picture": ("picture .png", "a.png", _linked("/dev/zero")),
    "a device for a video": ("video .mp4", "v.mp4", _linked("/dev/zero")),
    "a device for an arm": ("arm MJCF", "file.xml", _linked("/dev/zero")),
    "a device for a recipe": ("recipe", "recipe.toml", _linked("/dev/zero")),
    "a pipe for poses": ("poses", "file.csv", os.mkfifo),
    "a pipe for a video": ("video .avi", "v.avi", os.mkfifo),
    "a pipe for a baseline": ("baseline", "file.json", os.mkfifo),
    "a folder for corners": ("corner lists", "model.txt", lambda path: path.mkdir()),
}  # fmt: skip
"""Name -> reader, its file, and what is put there."""


def planted(subject: Subject, good: Files, bomb: str) -> Callable[[Path], None]:
    """What puts good files and a bomb among them into a folder."""
    _, file, content = BOMBS[bomb]

    def write(folder: Path) -> None:
        Case(subject, [good], 0).write(folder)
        (folder / file).unlink(missing_ok=True)
        if isinstance(content, bytes):
            (folder / file).write_bytes(content)
        else:
            content(folder / file)

    return write


def main() -> None:
    """Read each in a process of its own; `{name: [end, seconds, MB]}` on stdout."""
    answers = {}
    with tempfile.TemporaryDirectory() as root:
        folder = Path(root) / "case"
        folder.mkdir()
        for bomb, (name, _, _) in BOMBS.items():
            subject = SUBJECTS[name]
            good = subject.seeds(Path(root) / "seeds")[0]
            attempt(
                subject, Case(subject, [good], 0).write, folder
            )  # what it imports is not the bomb's fault
            write = planted(subject, good, bomb)
            answers[bomb] = apart(
                lambda subject=subject, write=write: attempt(subject, write, folder), LIMIT_MB, LIMIT_S
            )
            shutil.rmtree(folder)
            folder.mkdir()
    print(json.dumps(answers))


if __name__ == "__main__":
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    main()
