"""Proves that every encoding gives the picture that was recorded, and that damage is named."""

import cv2
import numpy as np
import pytest

from tests.bag.bags import packed, raw, write_bag
from vision_robot.bag import Bag
from vision_robot.bag.encodings import ENCODINGS
from vision_robot.errors import BadBag

BLUE, GREEN, RED = 0, 1, 2
# Even in colour but for a slow ramp: mosaics and shared chroma then lose next to nothing.
RAMP = np.linspace(0, 40, 32, dtype=np.uint8)[None, :] + np.zeros((24, 1), np.uint8)
COLOUR = np.stack([30 + RAMP, 90 + RAMP, 200 + RAMP], axis=-1)
GREY = np.random.default_rng(2).integers(0, 256, (24, 32), dtype=np.uint8)

# By the name alone: what the first two rows begin with.
BAYER = {
    "rggb": ((RED, GREEN), (GREEN, BLUE)),
    "bggr": ((BLUE, GREEN), (GREEN, RED)),
    "gbrg": ((GREEN, BLUE), (RED, GREEN)),
    "grbg": ((GREEN, RED), (BLUE, GREEN)),
}


def seen(tmp_path, *messages):
    return [frame.image for frame in Bag(write_bag(tmp_path, "ros1", {"/a": list(messages)}))]


def mosaic(pattern):
    samples = np.zeros(COLOUR.shape[:2], np.uint8)
    for row, names in enumerate(pattern):
        for column, channel in enumerate(names):
            samples[row::2, column::2] = COLOUR[row::2, column::2, channel]
    return samples


@pytest.mark.parametrize("encoding", ["mono8", "8UC1"])
@pytest.mark.parametrize("padding", [0, 6])
def test_grey(tmp_path, encoding, padding):
    (image,) = seen(tmp_path, raw(GREY, encoding, padding=padding))
    np.testing.assert_array_equal(image, GREY)


@pytest.mark.parametrize(
    ("encoding", "order"),
    [
        ("bgr8", [0, 1, 2]),
        ("8UC3", [0, 1, 2]),
        ("rgb8", [2, 1, 0]),
        ("bgra8", [0, 1, 2, 2]),
        ("rgba8", [2, 1, 0, 0]),
    ],
)
def test_colour(tmp_path, encoding, order):
    (image,) = seen(tmp_path, raw(COLOUR[..., order], encoding, padding=5))
    np.testing.assert_array_equal(image, COLOUR)


@pytest.mark.parametrize("big_endian", [False, True])
@pytest.mark.parametrize("bits", [10, 12, 16])
def test_sixteen_bits_are_scaled_from_what_they_hold(tmp_path, bits, big_endian):
    deep = GREY.astype(np.uint16) << (bits - 8)
    (image,) = seen(tmp_path, raw(deep, "mono16", big_endian=big_endian))
    np.testing.assert_array_equal(image, GREY)


def test_a_dark_picture_after_a_bright_one_stays_dark(tmp_path):
    deep = GREY.astype(np.uint16) << 8
    _, dark = seen(tmp_path, raw(deep, "mono16"), raw(deep >> 6, "mono16"))
    assert dark.max() <= 4


@pytest.mark.parametrize("name", BAYER)
@pytest.mark.parametrize("bits", [8, 16])
def test_bayer_patterns_mean_what_they_are_called(tmp_path, name, bits):
    samples = mosaic(BAYER[name])
    deep = samples if bits == 8 else samples.astype(np.uint16) << 8
    (image,) = seen(tmp_path, raw(deep, f"bayer_{name}{bits}"))
    inside = np.s_[3:-3, 3:-3]
    assert np.abs(image[inside].astype(int) - COLOUR[inside]).max() <= 3


@pytest.mark.parametrize("name", ["yuv422", "uyvy", "yuv422_yuy2", "yuyv"])
def test_yuv(tmp_path, name):
    y, v, u = np.moveaxis(cv2.cvtColor(COLOUR, cv2.COLOR_BGR2YCrCb), -1, 0)
    # Broadcast luma runs from 16 to 235, chroma from 16 to 240.
    luma = np.rint(16 + y * (219 / 255)).astype(np.uint8)
    chroma = np.rint(128 + (np.where(np.arange(32) % 2, np.roll(v, 1, 1), u).astype(float) - 128) * 224 / 255)
    pair = (chroma.astype(np.uint8), luma) if name in ("yuv422", "uyvy") else (luma, chroma.astype(np.uint8))
    (image,) = seen(tmp_path, raw(np.stack(pair, axis=-1), name))
    assert np.abs(image.astype(int) - COLOUR).max() <= 6


def test_compressed_grey_and_transparent(tmp_path):
    alpha = np.dstack([COLOUR, np.full(COLOUR.shape[:2], 9, np.uint8)])
    grey, colour = seen(tmp_path, packed(GREY), packed(alpha))
    np.testing.assert_array_equal(grey, GREY)
    np.testing.assert_array_equal(colour, COLOUR)


def test_every_encoding_is_tried_here():
    tried = {"mono8", "8UC1", "mono16", "bgr8", "8UC3", "rgb8", "bgra8", "rgba8", "yuv422", "uyvy", "yuyv"}
    tried |= {f"bayer_{name}{bits}" for name in BAYER for bits in (8, 16)} | {"yuv422_yuy2"}
    # Synonyms of tried ones, or the same with another order of bytes.
    assert set(ENCODINGS) - tried == {"16UC1", "8UC4", "bgr16", "rgb16"}


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"encoding": "32FC1"}, "its encoding is '32FC1': it must be one of mono8"),
        ({"height": 2400}, "it holds 768 bytes of 76800"),
        ({"step": 31}, "it claims 32x24 px in rows of 31 bytes"),
        ({"width": 0}, "it claims 0x24 px"),
    ],
)
def test_messages_that_contradict_themselves(tmp_path, changes, says):
    with pytest.raises(BadBag, match="picture 0 of /a: ") as caught:
        seen(tmp_path, raw(GREY, "mono8") | changes)
    assert says in str(caught.value)


def test_damaged_compressed_pictures(tmp_path):
    with pytest.raises(BadBag, match="said to be 'png', cannot be decoded"):
        seen(tmp_path, packed(GREY) | {"data": np.zeros(40, np.uint8)})
