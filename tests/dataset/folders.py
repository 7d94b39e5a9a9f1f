"""Folders in other people's layouts, made for tests."""

from pathlib import Path

import cv2
import numpy as np

__all__ = ["GT", "otb_folder", "pictures", "traffic_sequence"]

GT = """1,1,301.0,41.0,31.0,21.0,1,1,1.0
2,1,303.5,42.0,31.0,21.0,1,1,0.5
2,7,11,12,40,30,0,8,1
1,2,101,201,60.5,44,1,1,0.25
"""


def traffic_sequence(folder: Path, *, frames: int = 4, gt: str = GT) -> Path:
    """Real frames of a street (PyPI's mvtb-data) as a MOTChallenge sequence, labels written by hand."""
    import mvtbdata

    video = cv2.VideoCapture(str(Path(mvtbdata.__file__).parent / "images" / "traffic_sequence.mp4"))
    sequence = folder / "street"
    (sequence / "img1").mkdir(parents=True)
    (sequence / "gt").mkdir()
    for i in range(frames):
        readable, image = video.read()
        assert readable
        cv2.imwrite(str(sequence / "img1" / f"{i + 1:06d}.jpg"), image)
    video.release()
    (sequence / "gt" / "gt.txt").write_text(gt)
    (sequence / "seqinfo.ini").write_text(
        "[Sequence]\nname=street\nimDir=img1\nframeRate=25\nseqLength=4\nimWidth=704\nimHeight=576\nimExt=.jpg\n"
    )
    return sequence


def pictures(folder: Path, names: list[str], size: tuple[int, int] = (40, 30)) -> None:
    """Pictures whose grey value is 10 times their place in the list."""
    folder.mkdir(parents=True, exist_ok=True)
    for i, name in enumerate(names):
        cv2.imwrite(str(folder / name), np.full((size[1], size[0], 3), 10 * i, dtype=np.uint8))


def otb_folder(folder: Path, rows: str) -> Path:
    """An OTB sequence of three frames."""
    pictures(folder / "Ball" / "img", ["0001.png", "0002.png", "0003.png"])
    (folder / "Ball" / "groundtruth_rect.txt").write_text(rows)
    return folder / "Ball"
