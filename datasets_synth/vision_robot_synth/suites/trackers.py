"""Suite `trackers`: who follows objects best, on which axis of difficulty, and until when."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from vision_robot.dataset import sequences_in
from vision_robot.dataset.sequences import fingerprint
from vision_robot.errors import BadDataset
from vision_robot.evaluate.claim import Claim
from vision_robot.evaluate.dial import scene_at
from vision_robot.evaluate.peers.contestants import contestant_class, contestant_names
from vision_robot.evaluate.sweep import Cell
from vision_robot_synth.suites import tracker_cells
from vision_robot_synth.suites.suite import Plan, Suite

__all__ = ["SUITE"]

AXES = (
    "speed", "motion-blur", "noise", "illumination-drift", "shadow", "occlusion", "similar-colours",
    "near-background", "clutter", "camera-shake", "stop-and-go", "crowd",
)  # fmt: skip
"""Recipes with a dial each."""

MEANINGS = {
    "speed": "speed of the rod, 0: 20, 1: 1500 mm/s, with an ordinary shutter",
    "motion-blur": "share of the frame time that the shutter is open, up to 0.95, at 600 mm/s",
    "noise": "noise of read-out, up to 30 levels, and of photons",
    "illumination-drift": "how far light, exposure and white balance wander, and a soft shade",
    "shadow": "how far and how hard the shadows of posts swing",
    "occlusion": "hanging boards that objects pass under, up to 5",
    "similar-colours": "colour of other rods that wander about, from blue to the very same red",
    "near-background": "colour of the rod, from red to that of the table",
    "clutter": "other things that lie about, up to 36",
    "camera-shake": "trembling of the camera, up to 6 mm and 0.6 degrees",
    "stop-and-go": "how long the rod stops each time, up to 4 s",
    "crowd": "number of rods, 4 to 30, of two colours",
}
"""What severity is on each dial."""

SEVERITIES = (0.0, 0.3, 0.6, 1.0)

SCENES: dict[str, tuple[str, float]] = {
    "single-rod": ("single-rod", 0.5),
    "many-objects": ("many-objects", 0.5),
    "conveyor": ("conveyor", 0.25),
    "gripper-approach": ("gripper-approach", 0.5),
    **{scene_at(axis, severity): (axis, severity) for axis in AXES for severity in SEVERITIES},
}
"""Scene -> (recipe, severity)."""

QUICK_SCENES = ("single-rod", *(scene_at(axis, severity) for axis in AXES for severity in (0.3, 1.0)))
QUICK_PEERS = ("cv2-mog2", "cv2-knn", "cv2-cnt")
QUICK_FRAMES = 60

SIZE, FRAMES, TIMED_SIZE = (320, 240), 60, (640, 480)
TIMED_SEEDS, VARIED_SEEDS = 2, 3

FACTORS = (0.5, 2.0)
"""By which each option is varied, one at a time."""

AUTOMATIC = {
    "optical-flow": ("threshold_px", "closing_px", "min_area_px"),
    "rgb": ("min_area_px",),
    "background": ("threshold", "closing_px", "min_area_px"),
}
"""Options that trackers of ours choose from the data, and tell."""

TOGETHER = 4
"""Videos whose cells take turns, so that several processes render at the same time."""

Video = Mapping[str, Any]


def cells(plan: Plan) -> Sequence[Cell]:
    """Every scene by every method by every seed; variants of options and times on the first scene."""
    scenes, methods = SUITE.chosen(plan)
    if plan.quick:
        scenes = plan.scenes or QUICK_SCENES
        methods = plan.methods or tuple(name for name in methods if _is_quick(name, plan))
    frames, size = plan.frames or (QUICK_FRAMES if plan.quick else FRAMES), plan.size or SIZE

    def video(scene: str, seed: int, size: tuple[int, int]) -> Video:
        recipe, severity = SCENES[scene]
        return {"recipe": recipe, "severity": severity, "seed": seed, "frames": frames, "size": list(size)}

    seeds = plan.seed_range
    timed_size = plan.size or (SIZE if plan.quick else TIMED_SIZE)
    timed = {(scenes[0], seed): video(scenes[0], seed, timed_size) for seed in seeds[:TIMED_SEEDS]}
    some = {(scenes[0], seed): video(scenes[0], seed, size) for seed in seeds[:VARIED_SEEDS]}
    every = {(scene, seed): video(scene, seed, size) for seed in seeds for scene in scenes}
    return [
        *_scored(every, methods, plan),
        *(() if plan.quick else _variants(some, methods, plan)),
        *_timed(dict(list(timed.items())[: 1 if plan.quick else None]), methods, plan),
    ]


def on_data(folder: Path) -> Suite:
    """The same methods on labelled videos (MOTChallenge, OTB or our own layout); each is its own seed."""
    found = {name: data for name, data in sequences_in(folder).items() if len(data.truth)}
    if not found:
        raise BadDataset(folder, "no video in it has boxes of objects")
    names = list(found)

    def cells_of_data(plan: Plan) -> Sequence[Cell]:
        scenes, methods = suite.chosen(plan)
        if plan.quick:
            methods = plan.methods or tuple(name for name in methods if _is_quick(name, plan))
        videos = {
            (scene, names.index(scene)): {
                "folder": str(found[scene].path.absolute()),
                "mark": fingerprint(found[scene]),
            }
            for scene in scenes
        }
        first = dict(list(videos.items())[:1])
        return [
            *_scored(videos, methods, plan),
            *(() if plan.quick else _variants(first, methods, plan)),
            *_timed(first, methods, plan),
        ]

    suite = replace(SUITE, scenes=tuple(names), cells=cells_of_data, on_data=None)
    return suite


def _is_quick(name: str, plan: Plan) -> bool:
    return not name.startswith("cv2-") or name in QUICK_PEERS or name in plan.programs


def _scored(videos: Mapping[tuple[str, int], Video], methods: Sequence[str], plan: Plan) -> Iterator[Cell]:
    places = list(videos)
    # One film strip a scene and method is enough to look at.
    filmed = set({scene: (scene, seed) for scene, seed in reversed(places)}.values())
    for first in range(0, len(places), TOGETHER):
        for method in methods:
            for scene, seed in places[first : first + TOGETHER]:
                video = videos[scene, seed]
                told = {"video": video, "strip": True} if (scene, seed) in filmed else {"video": video}
                if method in plan.programs:
                    yield _cell(
                        scene, method, seed, "command_figures", {"command": plan.programs[method], **told}
                    )
                else:
                    yield _cell(scene, method, seed, "tracker_figures", {"method": method, **told})


def _variants(videos: Mapping[tuple[str, int], Video], methods: Sequence[str], plan: Plan) -> Iterator[Cell]:
    for (scene, seed), video in videos.items():
        for method in methods:
            for option, factor, shown in () if method in plan.programs else _options(method):
                told = {"method": method, "video": video, "option": option, "factor": factor}
                yield _cell(scene, f"{method}:{option}={shown}", seed, "variant_figures", told)


def _options(method: str) -> Iterator[tuple[str, float, str]]:
    """Options that are numbers, with factors that make a difference and how the variant is called."""
    for one in fields(contestant_class(method).Options):
        usual = one.default
        for factor in FACTORS:
            if one.name in AUTOMATIC.get(method, ()) and usual is None:
                yield one.name, factor, f"x{factor:g}"
            elif isinstance(usual, int | float) and not isinstance(usual, bool) and usual > 0:
                value = tracker_cells.varied(one.name, usual, factor)
                if value != usual:
                    yield one.name, factor, f"{value:g}"


def _timed(videos: Mapping[tuple[str, int], Video], methods: Sequence[str], plan: Plan) -> Iterator[Cell]:
    for (scene, seed), video in videos.items():
        for method in methods:
            if method not in plan.programs:
                told = {"method": method, "video": video}
                yield _cell(scene, method, seed, "tracker_times", told, alone=True)


def _cell(
    scene: str, method: str, seed: int, name: str, told: Mapping[str, Any], *, alone: bool = False
) -> Cell:
    return Cell("trackers", scene, method, seed, f"{tracker_cells.__name__}:{name}", told, alone)


CLAIMS = (
    Claim("the text", "rgb", ("optical-flow", "background")),
    Claim("the text, of its own forms,", "rgb-plain", ("optical-flow-plain", "background-plain")),
)
"""The text: of the three, the RGB tracker "had a better response and results"."""

TIMING = (
    "Times are of cells that ran alone, after all others: one process, one thread, frames in memory, on "
    "the first scene, at 640x480 px unless a size was asked for; "
    f"the first {tracker_cells.WARM_UP} frames do not count. They depend on the machine; ratios between "
    "methods of one run carry further."
)

SUITE = Suite(
    "trackers",
    tuple(SCENES),
    tuple(contestant_names()),
    "hota",
    0.5,
    cells,
    on_data=on_data,
    timing=TIMING,
    axes=MEANINGS,
    claims=CLAIMS,
    video_of=lambda cell: video if "recipe" in (video := cell.parameters["video"]) else None,
)
