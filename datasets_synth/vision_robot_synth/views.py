"""Recipes of kind "views": calibration sets by the same words as videos."""

import dataclasses

from vision_robot.calibrate.boards import board_named
from vision_robot.errors import BadRecipe
from vision_robot.geometry import Camera
from vision_robot_synth.calibration import TRUTH, CalibrationSet, calibration_set
from vision_robot_synth.recipe import Recipe
from vision_robot_synth.sensor import Sensor

__all__ = ["views_of"]


def views_of(recipe: Recipe, *, severity: float, seed: int) -> CalibrationSet:
    """The calibration set of a recipe. Raises BadRecipe for effects that only videos have."""
    turned = recipe.at(severity)
    video, part, sensor = turned.video, turned.board, turned.sensor(seed)
    used = {
        field.name
        for field in dataclasses.fields(sensor)
        if getattr(sensor, field.name) != field.default and field.name not in ("blur_px", "read_noise")
    }
    if used:
        raise BadRecipe(
            recipe.name, f"views know sensor.blur_px and read_noise, not {', '.join(sorted(used))}"
        )
    board = board_named(part.name, part.size, part.square_mm / 1e3)
    return calibration_set(
        _camera(video.size),
        board,
        views=video.frames,
        seed=seed,
        sensor=Sensor(sensor.blur_px, sensor.read_noise),
    )


def _camera(size: tuple[int, int]) -> Camera:
    """The lens of `TRUTH` on a sensor of that many pixels, as wide as before."""
    width, height = size
    scale = width / TRUTH.width
    return dataclasses.replace(
        TRUTH,
        width=width,
        height=height,
        fx=TRUTH.fx * scale,
        fy=TRUTH.fy * scale,
        cx=(TRUTH.cx + 0.5) * scale - 0.5,
        cy=(height - 1) / 2 + (TRUTH.cy - (TRUTH.height - 1) / 2) * scale,
    )
