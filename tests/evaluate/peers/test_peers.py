"""Peers behind our protocol: each follows a bright square that moves over a speckled table."""

import sys
import textwrap

import numpy as np
import pytest

from vision_robot.errors import BadParameter, BadTable, PeerFailed
from vision_robot.evaluate.peers import PEERS, peer_named
from vision_robot.evaluate.peers.command import tracks_of_command

SIDE, STEP, FIRST = 30, 4, 20
ONE_OBJECT = ("cv2-csrt", "cv2-kcf", "cv2-mil", "cv2-camshift")
RNG = np.random.default_rng(0)
TABLE = RNG.integers(60, 90, (160, 240, 3), dtype=np.uint8)
# Shaded, so that those who compare textures have one, and far from the table in grey levels and in hue.
SQUARE = np.linspace([40, 120, 220], [90, 200, 255], SIDE).astype(np.uint8)
BLACK = [np.zeros((48, 64, 3), np.uint8)]


def frame(k: int) -> np.ndarray:
    """Empty for twenty frames, so that a background can be learned; then the square comes by."""
    picture = TABLE + RNG.integers(0, 6, TABLE.shape, dtype=np.uint8)
    if k >= FIRST:
        left, top = corner(k)
        picture[top : top + SIDE, left : left + SIDE] = SQUARE
    return picture


def corner(k: int) -> tuple[int, int]:
    return 20 + STEP * (k - FIRST), 60


@pytest.mark.parametrize("name", [name for name in PEERS if name != "cv2-gmg"])  # which wants a longer look
def test_a_peer_finds_the_square(name):
    left, top = corner(FIRST)
    options = {"box_px": (left - 0.5, top - 0.5, SIDE, SIDE)} if name in ONE_OBJECT else {}
    peer = peer_named(name, options)
    apart = []
    for k in range(FIRST if options else 0, 60):
        blobs = peer.step(frame(k), k / 25)
        if k >= FIRST + 10:
            middle = np.array(corner(k)) + (SIDE - 1) / 2
            away = np.linalg.norm(blobs.centroid_px[blobs.area_px > 200] - middle, axis=1)
            apart.append(away.min(initial=np.inf))
    assert np.median(apart) < 8
    assert peer.mask.shape == TABLE.shape[:2]
    assert peer.mask.any()


def test_what_follows_one_object_asks_for_its_box():
    with pytest.raises(BadParameter, match=r"cv2-kcf\.box_px"):
        peer_named("cv2-kcf")
    with pytest.raises(BadParameter, match="cv2-mog2"):
        peer_named("mog2")


PROGRAM = """
    import sys
    import cv2
    video, out = sys.argv[1:]
    capture, rows, frame = cv2.VideoCapture(video), ["frame,id,u_px,v_px"], 0
    while True:
        good, image = capture.read()
        if not good:
            break
        rows.append(f"{frame},1,{float(image.mean())},{image.shape[0]}")
        frame += 1
    open(out, "w").write("\\n".join(rows))
"""


def command(tmp_path, program: str) -> str:
    script = tmp_path / "a tracker.py"
    script.write_text(textwrap.dedent(program))
    return f"{sys.executable} '{script}' {{video}} {{out}}"


def test_any_program_can_take_part(tmp_path):
    frames = [np.full((48, 64, 3), 10 * k, np.uint8) for k in range(5)]
    tracks = tracks_of_command(command(tmp_path, PROGRAM), frames, (64, 48), 25)
    assert tracks.centroid_px[:, 0].tolist() == [0, 10, 20, 30, 40]


def test_a_program_that_fails_is_named_with_its_last_words(tmp_path):
    failing = command(tmp_path, "import sys; print('no weights', file=sys.stderr); sys.exit(3)")
    with pytest.raises(PeerFailed, match="exit code 3: no weights"):
        tracks_of_command(failing, BLACK, (64, 48), 25)
    with pytest.raises(PeerFailed, match="no-such-program"):
        tracks_of_command("no-such-program {video} {out}", BLACK, (64, 48), 25)
    with pytest.raises(BadTable):
        tracks_of_command(command(tmp_path, "pass"), BLACK, (64, 48), 25)
    with pytest.raises(BadParameter, match=r"\{video\}"):
        tracks_of_command("program", BLACK, (64, 48), 25)
