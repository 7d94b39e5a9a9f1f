"""Suite `grasp`: what breaks picking, by fault and its size, and what closing the loop gives back."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from vision_robot.evaluate.dial import scene_at
from vision_robot.evaluate.sweep import Cell, Measured
from vision_robot.pick.closed_loop import LAWS
from vision_robot.pick.episodes import OPEN, run_episode
from vision_robot.pick.episodes import Plan as PickPlan
from vision_robot.pick.faults import with_fault, with_lens
from vision_robot.pick.film import Still, Stills
from vision_robot.pick.world import CAMERA, World, ordinary_world
from vision_robot.report.film_strip import film_strip
from vision_robot_synth.suites.suite import Plan, Suite

__all__ = ["SUITE", "faulty_world", "grasp_figures"]

TRACKERS: dict[str, dict[str, str]] = {"rgb": {"color": "red"}, "background": {}, "optical-flow": {}}
"""Name -> options: the rod of the cell is red, and who looks at colours is told."""

METHODS: dict[str, tuple[str, str]] = {
    OPEN: (OPEN, "rgb"),
    **{law: (law, "rgb") for law in LAWS},
    "open-background": (OPEN, "background"),
    "open-optical-flow": (OPEN, "optical-flow"),
}
"""Name -> (loop, tracker)."""

DIALS: dict[str, tuple[str, float, tuple[float, ...]]] = {
    "camera-rotation-deg": ("camera-rotation", np.pi / 180, (0.25, 0.5, 1, 2)),
    "camera-shift-mm": ("camera-translation", 1e-3, (2, 5, 10, 20)),
    "square-size-percent": ("square-size", 0.01, (0.5, 1, 2, 4)),
    "ignored-distortion": ("ignored-distortion", 1.0, (0.5, 1, 2)),
    "joint-offset-deg": ("joint-offset", np.pi / 180, (0.25, 0.5, 1, 2)),
    "backlash-deg": ("backlash", np.pi / 180, (0.25, 0.5, 1, 2)),
    "corner-noise-px": ("corner-noise", 1.0, (0.2, 0.5, 1)),
    "image-noise-levels": ("image-noise", 1.0, (5, 10, 20)),
    "latency-ms": ("latency", 1e-3, (100, 200, 400)),
}
"""Dial -> (fault, its unit in SI, severities)."""

NOMINAL, KNOCKED = "nominal", "knocked-1deg-5mm"

SCENES: dict[str, dict[str, float]] = {
    NOMINAL: {},
    KNOCKED: {"camera-rotation": float(np.radians(1)), "camera-translation": 0.005},
    **{
        scene_at(dial, severity): {fault: unit * severity}
        for dial, (fault, unit, severities) in DIALS.items()
        for severity in severities
    },
}

QUICK = (NOMINAL, KNOCKED, *(f"camera-rotation-deg={size:g}" for size in DIALS["camera-rotation-deg"][2]))
"""What a look in minutes is content with."""

SHOWN = ("seen", "down", "lift")
"""Phases whose ends stand in a film strip, besides the last picture."""

AXES = {
    "camera-rotation-deg": "the camera is turned after it was calibrated [°]",
    "camera-shift-mm": "the camera is shifted after it was calibrated [mm]",
    "square-size-percent": "the board's squares are larger than typed [%]",
    "ignored-distortion": "distortion of the lens, fitted by a model without any (1: the usual lens)",
    "joint-offset-deg": "encoders off, from joint to joint to the other side [°]",
    "backlash-deg": "play in every turning joint [°]",
    "corner-noise-px": "noise of the calibration's corners [px]",
    "image-noise-levels": "noise of the pictures [grey levels]",
    "latency-ms": "from a picture to its answer [ms]",
}

FOR_TRACKERS = (NOMINAL, *(scene for scene in SCENES if scene.startswith("image-noise")))
"""Scenes in which it matters who looks; elsewhere the loops are run with one tracker."""


def cells(plan: Plan) -> Sequence[Cell]:
    """Every scene by every loop by every seed; trackers where they matter, or where they are asked for."""
    scenes, methods = SUITE.chosen(plan)
    if plan.quick and not plan.scenes:
        scenes = QUICK
    return [
        Cell("grasp", scene, method, seed, f"{__name__}:grasp_figures",
             # One film strip a scene and method is enough to look at.
             {"method": method, "seed": seed, "faults": SCENES[scene], "strip": seed == plan.first_seed})
        for seed in plan.seed_range
        for scene in scenes
        for method in methods
        if plan.methods or METHODS[method][1] == "rgb" or scene in FOR_TRACKERS
    ]  # fmt: skip


def grasp_figures(
    workspace: Path,  # noqa: ARG001 - nothing is shared between cells
    method: str,
    seed: int,
    faults: Mapping[str, float],
    *,
    strip: bool = False,
) -> Measured:
    """One episode: how far it got, and how far off; NaN where it did not come to that.

    The same seed has the same rod at the same place, the same calibration and the same noise for all
    methods: they are compared in pairs.
    """
    loop, tracker = METHODS[method]
    options: Mapping[str, Any] = TRACKERS[tracker]
    stills = Stills() if strip else None
    episode = run_episode(faulty_world(faults), PickPlan(tracker, options, loop), seed, witness=stills)
    closing, placing = episode.closing, episode.placing
    figures = {
        "grasp_success": float(episode.lifted),
        "place_success": float(episode.placed),
        "position_error_mm": 1000 * closing.position_m if closing else np.nan,
        "yaw_error_deg": abs(float(np.degrees(closing.yaw_rad))) if closing else np.nan,
        "place_error_mm": 1000 * placing.position_m if placing else np.nan,
        "pick_s": episode.seconds,
    }
    return Measured(figures, None if stills is None else _strip(stills.pictures))


def _strip(pictures: Sequence[Still]) -> str:
    """What was seen, the tool come down, and what came of it."""
    shown = [one for one in pictures[:-1] if one.phase in SHOWN] + [pictures[-1]]
    nobody = [np.zeros((0, 4))] * len(shown)
    return film_strip([one.image for one in shown], nobody, nobody, names=[one.phase for one in shown])


def faulty_world(faults: Mapping[str, float]) -> World:
    """The ordinary cell with all the faults, sizes in SI.

    `ignored-distortion` is no fault of `vr pick`: a camera with so many times the ordinary one's distortion,
    calibrated with a model that has none.
    """
    world = ordinary_world()
    for name, size in faults.items():
        if name == "ignored-distortion":
            bent = replace(CAMERA, distortion=tuple(size * k for k in CAMERA.distortion))
            world = with_lens(replace(world, view=replace(world.view, camera=bent)), "pinhole")
        else:
            world = with_fault(world, name, size)
    return world


SUITE = Suite("grasp", tuple(SCENES), tuple(METHODS), "grasp_success", 0.5, cells, axes=AXES)
