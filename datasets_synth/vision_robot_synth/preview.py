"""A dataset at a glance: a contact sheet and a short film, with the truth drawn in."""

import colorsys
from pathlib import Path

import cv2
import numpy as np

from vision_robot.dataset import Dataset, FlowField
from vision_robot.files import write_bytes
from vision_robot.types import Array, Image, Int
from vision_robot.video import VideoWriter

__all__ = ["contact_sheet", "write_film", "write_preview"]

COLUMNS, ROWS = 4, 3
TILE_PX = 400
FILM_PX = 480
FILM_S = 6.0
GAP_PX = 4


def write_preview(dataset: Dataset, folder: Path | str) -> list[Path]:
    """Write preview.png and preview.webm into a folder; gives their paths."""
    sheet, film = Path(folder) / "preview.png", Path(folder) / "preview.webm"
    write_bytes(sheet, cv2.imencode(".png", contact_sheet(dataset))[1].tobytes())
    write_film(dataset, film)
    return [sheet, film]


def contact_sheet(dataset: Dataset) -> Image:
    """Twelve frames with their boxes; below them masks and flow of four, where there are any."""
    shown = np.linspace(0, len(dataset) - 1, COLUMNS * ROWS).round().astype(int).tolist()
    tiles = [_tile(_boxed(dataset, index)) for index in shown]
    for picture in (_masks_of, _flow_of):
        below = [picture(dataset, index) for index in shown[:: len(shown) // COLUMNS]]
        tiles += [_tile(one) for one in below if one is not None]
    rows = [np.hstack([_framed(t) for t in tiles[i : i + COLUMNS]]) for i in range(0, len(tiles), COLUMNS)]
    return np.vstack([row for row in rows if row.shape == rows[0].shape])


def write_film(dataset: Dataset, path: Path | str, *, width_px: int = FILM_PX, whole: bool = False) -> None:
    """Write a film of the frames, at most `width_px` wide; of the first seconds, or the `whole` of it."""
    width = min(width_px, dataset.size[0])
    size = (width // 2 * 2, round(width * dataset.size[1] / dataset.size[0] / 2) * 2)
    stop = len(dataset) if whole else min(len(dataset), max(2, int(FILM_S * dataset.fps)))
    with VideoWriter(path, size, dataset.fps) as film:
        for frame in dataset.frames(0, stop):
            film.write(_scaled(_coloured(frame.image), size))


def _boxed(dataset: Dataset, index: int) -> Image:
    image = _coloured(dataset.frame(index).image).copy()
    rows = dataset.truth.rows(dataset.truth.frame == index)
    thick = max(1, round(dataset.size[0] / 500))
    for id_, box in zip(rows.id.tolist(), rows.box_px, strict=True):
        if np.isfinite(box).all():
            (left, top), (right, bottom) = box[:2] + 0.5, box[:2] + box[2:] - 0.5
            corners = [(round(left), round(top)), (round(right), round(bottom))]
            cv2.rectangle(image, corners[0], corners[1], _colour_of(id_), thick)
            place = (corners[0][0], max(corners[0][1] - 3, 12))
            cv2.putText(image, str(id_), place, cv2.FONT_HERSHEY_SIMPLEX, 0.5 * thick, _colour_of(id_), thick)
    label, where = f"{index}", (6, image.shape[0] - 8)
    cv2.putText(image, label, where, cv2.FONT_HERSHEY_SIMPLEX, 0.5 * thick, (255, 255, 255), thick)
    return image


def _masks_of(dataset: Dataset, index: int) -> Image | None:
    ids = dataset.masks(index)
    if ids is None:
        return None
    table = np.array(
        [(30, 30, 30), *(_colour_of(id_) for id_ in range(1, int(ids.max()) + 1))], dtype=np.uint8
    )
    return table[ids]


def _flow_of(dataset: Dataset, index: int) -> Image | None:
    flow = dataset.flow(min(index, max(dataset.flow_files, default=0)))
    return None if flow is None else _flow_picture(flow)


def _flow_picture(flow: FlowField) -> Image:
    """Direction as hue, length as saturation on white; black where hidden in the next frame."""
    u, v = np.nan_to_num(flow.flow_px[..., 0]), np.nan_to_num(flow.flow_px[..., 1])
    length = np.hypot(u, v)
    hue = np.degrees(np.arctan2(v, u)) / 2 % 180
    full = max(float(length.max()), 1e-6)
    saturation = np.clip(255 * length / full, 0, 255)
    hsv = np.stack([hue, saturation, np.full_like(hue, 255)], axis=-1).astype(np.uint8)
    picture = cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR)
    picture[flow.occluded | ~flow.known] = 0
    return picture


def _colour_of(id_: int) -> tuple[int, int, int]:
    """A colour for an id, far from those of its neighbours."""
    red, green, blue = colorsys.hsv_to_rgb(id_ * 0.618034 % 1, 0.85, 1.0)
    return int(255 * blue), int(255 * green), int(255 * red)


def _tile(image: Image) -> Image:
    height, width = image.shape[:2]
    return _scaled(image, (TILE_PX, max(1, round(TILE_PX * height / width))))


def _framed(image: Image) -> Image:
    return cv2.copyMakeBorder(image, GAP_PX, GAP_PX, GAP_PX, GAP_PX, cv2.BORDER_CONSTANT, value=(20, 20, 20))


def _scaled(image: Image, size: tuple[int, int]) -> Image:
    smaller = size[0] < image.shape[1]
    return cv2.resize(image, size, interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR)


def _coloured(image: Int[Array, "h w *c"]) -> Image:
    return cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) if image.ndim == 2 else image
