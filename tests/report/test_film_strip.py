"""Film strips: frames beside each other, boxes where they belong, nothing but a picture."""

from base64 import b64decode

import cv2
import numpy as np
import pytest

from vision_robot.errors import BadParameter
from vision_robot.report.film_strip import FRAME_PX, GAP_PX, film_strip

GREY = np.full((90, 120, 3), 128, np.uint8)
BOX = np.array([[29.5, 19.5, 60.0, 40.0]])
NONE = np.zeros((0, 4))


def decoded(uri: str) -> np.ndarray:
    kind, _, data = uri.partition(",")
    assert kind == "data:image/jpeg;base64"
    strip = cv2.imdecode(np.frombuffer(b64decode(data), np.uint8), cv2.IMREAD_COLOR)
    assert strip is not None
    return strip.astype(int)


def test_frames_stand_side_by_side():
    strip = decoded(film_strip([GREY, GREY, GREY], [NONE] * 3, [NONE] * 3))
    assert strip.shape == (150, 3 * FRAME_PX + 2 * GAP_PX, 3)
    assert abs(strip[:, FRAME_PX // 2] - 128).max() < 4
    assert strip[75, FRAME_PX + GAP_PX // 2].min() > 230


def test_the_answer_is_orange_and_the_truth_white():
    scale = FRAME_PX / 120
    strip = decoded(film_strip([GREY, GREY], [BOX, NONE], [NONE, BOX]))
    row, column = round(scale * 40), round(scale * 29.5)
    truth, answer = strip[row, column], strip[row, FRAME_PX + GAP_PX + column]
    assert truth.min() > 190
    blue, green, red = answer
    assert red > 200
    assert green + 40 < red
    assert blue + 20 < green
    assert abs(strip[row, round(scale * 60)] - 128).max() < 8  # boxes are not filled


def test_boxes_that_are_not_known_and_grey_frames_do_no_harm():
    film_strip([GREY[..., 0]], [np.full((1, 4), np.nan)], [BOX], names=["frame 0"])
    with pytest.raises(BadParameter, match="the same number of each"):
        film_strip([GREY], [], [NONE])
