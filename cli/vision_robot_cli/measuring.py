"""The work of `vr measure`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.calibrate.boards import Board
from vision_robot.calibrate.detect import detect_board, seen_size
from vision_robot.errors import BadParameter, BoardNotFound, MixedImageSizes
from vision_robot.evaluate.flat_shape import FlatShape, flat_shape
from vision_robot.extrinsics.marked_points import read_table
from vision_robot.extrinsics.measuring import Measured, measure_points
from vision_robot.formats.work_plane import read_work_plane
from vision_robot.geometry import Camera, WorkPlane
from vision_robot.images import read_image
from vision_robot.types import Array, Float

__all__ = ["Found", "Points", "as_csv", "as_json", "as_text", "measured", "points", "work_plane"]

MOST_LENGTHS = 50
"""Lengths between so many points in a row are worth printing."""


@dataclass(frozen=True)
class Points:
    """Pixels to measure, and the board they belong to, if any."""

    names: list[str]
    pixels: Float[Array, "n 2"]
    sigma_px: Float[Array, "n"]
    board_points: Float[Array, "n 3"] | None = None


@dataclass(frozen=True)
class Found:
    """What was measured, and how the board's own shape compares."""

    points: Points
    measured: Measured
    shape: FlatShape | None

    @property
    def sigma_mm(self) -> Float[Array, "n 2"]:
        """One standard deviation in x and y."""
        return 1000 * self.measured.sigma_m


def work_plane(path: Path | None) -> WorkPlane:
    """The option --plane."""
    if path is None:
        raise BadParameter("--plane", None, "given: the file that 'vr extrinsics plane -o' wrote")
    return read_work_plane(path)


def points(
    camera: Camera,
    words: Sequence[str],
    table: Path | None,
    image: Path | None,
    board: Board | None,
    sigma_px: float,
) -> Points:
    """The arguments, --csv or --image: one of them."""
    if not (np.isfinite(sigma_px) and sigma_px >= 0):
        raise BadParameter("--sigma-px", sigma_px, "zero or positive")
    if sum((bool(words), table is not None, image is not None)) != 1:
        raise BadParameter("points", "none, or from several places", "pixels u,v, or --csv, or --image")
    if table is not None:
        columns = read_table(table, ("u_px", "v_px"), optional=("sigma_px",))
        pixels = np.stack([columns["u_px"], columns["v_px"]], axis=1)
        sigma = columns.get("sigma_px", np.full(len(pixels), sigma_px))
        if not len(pixels):
            raise BadParameter("--csv", str(table), "a file with at least one point")
        return Points([f"line {i + 2} of {table.name}" for i in range(len(pixels))], pixels, sigma)
    if image is not None:
        assert board is not None
        return _on_image(camera, image, board)
    pixels = np.array([_pair(word) for word in words])
    return Points([f"point {i + 1}" for i in range(len(words))], pixels, np.full(len(words), sigma_px))


def _pair(word: str) -> tuple[float, float]:
    try:
        u, v = (float(part) for part in word.split(","))
    except ValueError:
        raise BadParameter("pixel", word, "two numbers u,v such as 640,480.5") from None
    if not np.isfinite([u, v]).all():
        raise BadParameter("pixel", word, "two finite numbers")
    return u, v


def _on_image(camera: Camera, path: Path, board: Board) -> Points:
    image = read_image(path)
    size = (image.shape[1], image.shape[0])
    if size != (camera.width, camera.height):
        raise MixedImageSizes("the camera file", (camera.width, camera.height), path, size)
    seen = detect_board(image, board, name=path.name)
    if seen is None:
        raise BoardNotFound(1, f"{board.name} {board.size}", seen_size(image))
    names = [f"corner {i} of {path.name}" for i in seen.ids]
    return Points(names, seen.pixels, seen.sigma_px, board.points[seen.ids])


def measured(plane: WorkPlane, given: Points, z_m: float, sigma_z_m: float) -> Found:
    """Measure; raises OffPlane naming the first point that sees no plane."""
    if sigma_z_m < 0:
        raise BadParameter("--height-sigma", sigma_z_m, "zero or positive")
    found = measure_points(
        plane, given.pixels, given.sigma_px, names=given.names, z_m=z_m, sigma_z_m=sigma_z_m
    )
    shape = None
    if given.board_points is not None:
        shape = flat_shape(found.positions_m, given.board_points[:, :2])
    return Found(given, found, shape)


def as_json(found: Found, plane: Path | None) -> dict[str, Any]:
    """The object of `vr measure --json`."""
    import vision_robot

    measured, given = found.measured, found.points
    rows = zip(given.pixels, 1000 * measured.positions_m, found.sigma_mm, measured.covariance_m2, strict=True)
    shape = found.shape
    return {
        "points": [
            {
                "u_px": u,
                "v_px": v,
                "x_mm": x,
                "y_mm": y,
                "sigma_x_mm": sigma[0],
                "sigma_y_mm": sigma[1],
                "covariance_mm2": 1e6 * covariance,
            }
            for (u, v), (x, y), sigma, covariance in rows
        ],
        "lengths": [
            {"from": i, "to": i + 1, "length_mm": 1000 * length, "sigma_mm": 1000 * sigma}
            for i, (length, sigma) in enumerate(measured.lengths_m[:MOST_LENGTHS])
        ],
        "board": {
            "rms_mm": 1000 * shape.rms_m,
            "scale_error_percent": 100 * (shape.scale - 1),
        }
        if shape
        else None,
        "plane": str(plane),
        "version": vision_robot.__version__,
    }


def as_text(found: Found) -> str:
    """The result for a person at a terminal."""
    measured, given = found.measured, found.points
    lines = [f"{'u [px]':>10}{'v [px]':>10}{'x [mm]':>12}{'y [mm]':>12}{'sigma x':>10}{'sigma y':>10}"]
    for (u, v), (x, y), (sx, sy) in zip(
        given.pixels, 1000 * measured.positions_m, found.sigma_mm, strict=True
    ):
        lines.append(f"{u:10.2f}{v:10.2f}{x:12.3f}{y:12.3f}{sx:10.4f}{sy:10.4f}")
    if found.shape:
        rms, percent = 1000 * found.shape.rms_m, 100 * (found.shape.scale - 1)
        lines += ["", f"the board fits with {rms:.4f} mm rms, its size to {percent:+.3f} %"]
    elif len(measured.lengths_m) <= MOST_LENGTHS:
        lines += [""] if measured.lengths_m else []
        for i, (length, sigma) in enumerate(measured.lengths_m):
            lines.append(f"from point {i + 1} to {i + 2}: {1000 * length:.3f} +- {1000 * sigma:.4f} mm")
    return "\n".join(lines)


def as_csv(found: Found) -> str:
    """The table of --out."""
    lines = ["u_px,v_px,x_mm,y_mm,sigma_x_mm,sigma_y_mm"]
    for pixel, position, sigma in zip(
        found.points.pixels, 1000 * found.measured.positions_m, found.sigma_mm, strict=True
    ):
        lines.append(",".join(f"{value:.6f}" for value in (*pixel, *position, *sigma)))
    return "\n".join(lines) + "\n"
