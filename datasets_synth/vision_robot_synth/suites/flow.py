"""Suite `flow`: dense optical flow on rendered belts and tables, or on one's own pairs with true flow."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter, process_time

import cv2
import numpy as np

from vision_robot.dataset import Dataset, open_dataset, sequences_in
from vision_robot.dataset.sequences import fingerprint
from vision_robot.errors import BadDataset
from vision_robot.evaluate.dial import scene_at
from vision_robot.evaluate.peers.flow_methods import FLOW_METHODS, FlowMethod, flow_method
from vision_robot.evaluate.sweep import Cell
from vision_robot.flow import flow_error
from vision_robot.types import Array, Bool, Float
from vision_robot_synth.suites.rendered import rendered_set
from vision_robot_synth.suites.suite import Plan, Suite

__all__ = ["SUITE", "flow_figures", "flow_figures_of_data", "flow_time", "flow_time_of_data"]

RECIPES = Path(__file__).with_name("recipes")
SPEED, NOISE, LIGHT = (0.05, 0.15, 0.4, 1.0), (0.0, 0.2, 0.5, 1.0), (0.0, 0.3, 1.0)

SCENES: dict[str, tuple[str, float]] = {
    "many-objects": ("many-objects", 0.5),
    "camera-shake": ("camera-shake", 0.5),
    **{scene_at("speed", s): ("flow-speed", s) for s in SPEED},
    **{scene_at("noise", s): ("flow-noise", s) for s in NOISE},
    **{scene_at("light", s): ("flow-light", s) for s in LIGHT},
}
"""Scene -> (recipe, severity)."""

AXES = {
    "speed": "1 is a belt at 900 mm/s, 20 px from one frame to the next in pictures 320 px wide",
    "noise": "1 is read-out noise of 30 grey levels and shot noise with a variance of twice the light",
    "light": "1 is light that drifts by 35 %, exposure and white balance by 15 %, a shade of 60 %, in 0.5 s",
}
QUICK_SCENES, SLOW = ("many-objects", "speed=0.15", "noise=0.5"), ("cv2-tvl1",)
SIZE, FRAMES = (320, 240), 6
PAIRS = 2
"""Of one set: the first and the last; those between look alike."""

MOVES_PX = 0.5
"""Truth longer than this is motion."""

TIMED_SEEDS, REPEATS, LONG_S = 3, 9, 2.0

Pair = tuple[Array, Array, Float[Array, "h w 2"], Bool[Array, "h w"]]
"""Two grey pictures, the true flow between them, and where it counts: known, and seen in both."""


def cells(plan: Plan) -> Sequence[Cell]:
    """Every scene by every method by every seed, and times on the first scene."""
    scenes, methods = _quick(SUITE.chosen(plan), plan)
    video = {"frames": max(plan.frames or FRAMES, 2), "size": list(plan.size or SIZE)}

    def told(scene: str, seed: int) -> dict[str, object]:
        recipe, severity = SCENES[scene]
        return {"recipe": recipe, "severity": severity, "seed": seed, **video}

    return list(_cells(plan, scenes, methods, told, ("flow_figures", "flow_time")))


def _quick(
    chosen: tuple[tuple[str, ...], tuple[str, ...]], plan: Plan
) -> tuple[Sequence[str], Sequence[str]]:
    """What a quick plan leaves of all scenes and methods."""
    if not plan.quick:
        return chosen
    return plan.scenes or QUICK_SCENES, plan.methods or tuple(m for m in chosen[1] if m not in SLOW)


def _cells(
    plan: Plan,
    scenes: Sequence[str],
    methods: Sequence[str],
    told: Callable[[str, int], Mapping[str, object]],
    work: tuple[str, str],
) -> Iterator[Cell]:
    def cell(scene: str, method: str, seed: int, name: str, *, alone: bool = False) -> Cell:
        parameters = {"method": method, **told(scene, seed)}
        return Cell("flow", scene, method, seed, f"{__name__}:{name}", parameters, alone)

    for seed in plan.seed_range:
        for scene in scenes:
            yield from (cell(scene, method, seed, work[0]) for method in methods)
    for seed in plan.seed_range[:TIMED_SEEDS]:
        yield from (cell(scenes[0], method, seed, work[1], alone=True) for method in methods)


def flow_figures(
    workspace: Path, method: str, recipe: str, severity: float, seed: int, frames: int, size: list[int]
) -> dict[str, float]:
    """Errors of one method on the pairs of one rendered set."""
    return _errors(flow_method(method), _pairs(_rendered(workspace, recipe, severity, seed, frames, size)))


def flow_time(
    workspace: Path, method: str, recipe: str, severity: float, seed: int, frames: int, size: list[int]
) -> dict[str, float]:
    """Median time of one method for a pair of one rendered set."""
    return _time(flow_method(method), _pairs(_rendered(workspace, recipe, severity, seed, frames, size)))


def flow_figures_of_data(workspace: Path, method: str, folder: str, mark: str) -> dict[str, float]:  # noqa: ARG001
    """Errors of one method on all pairs of a sequence on disk; `mark` tells one state of it from another."""
    return _errors(flow_method(method), _pairs(open_dataset(folder), most=None))


def flow_time_of_data(workspace: Path, method: str, folder: str, mark: str) -> dict[str, float]:  # noqa: ARG001
    """Median time of one method for the first pair of a sequence on disk."""
    return _time(flow_method(method), _pairs(open_dataset(folder), most=1))


def on_data(folder: Path) -> Suite:
    """The same methods on the sequences in a folder that have true flow (Middlebury's layout, or ours)."""
    found = {name: data for name, data in sequences_in(folder).items() if data.flow_files}
    if not found:
        raise BadDataset(folder, "no sequence in it has true flow: flowNN.flo beside frameNN.png")
    names = list(found)

    def told(scene: str, seed: int) -> dict[str, object]:  # noqa: ARG001 - a sequence is its own seed
        return {"folder": str(found[scene].path.absolute()), "mark": fingerprint(found[scene])}

    def cells_of_data(plan: Plan) -> Sequence[Cell]:
        _, methods = _quick(suite.chosen(plan), plan)
        scenes, made = suite.chosen(plan)[0], list[Cell]()
        for scene in scenes:
            # A sequence is one observation: its number stands for the seed.
            one = replace(plan, seeds=1, first_seed=names.index(scene))
            work = ("flow_figures_of_data", "flow_time_of_data")
            made += _cells(one, [scene], methods, told, work)
        return made

    suite = replace(SUITE, scenes=tuple(names), cells=cells_of_data, on_data=None)
    return suite


def _rendered(
    workspace: Path, recipe: str, severity: float, seed: int, frames: int, size: list[int]
) -> Dataset:
    file = RECIPES / f"{recipe}.toml"
    return rendered_set(
        workspace, str(file) if file.exists() else recipe,
        severity=severity, seed=seed, frames=frames, size=(size[0], size[1]), flow="flo",
    )  # fmt: skip


def _pairs(data: Dataset, *, most: int | None = PAIRS) -> Iterator[Pair]:
    """Pairs with true flow, evenly taken where there are more than `most`."""
    known = sorted(data.flow_files)
    if most is not None and len(known) > most:
        known = [known[int(i)] for i in np.linspace(0, len(known) - 1, most)]
    for index in known:
        field = data.flow(index)
        assert field is not None, "it is listed"
        first, second = (_grey(data.frame(i).image) for i in (index, index + data.flow_step))
        yield first, second, field.flow_px, field.known & ~field.occluded


def _grey(image: Array) -> Array:
    return image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)


def _errors(method: FlowMethod, pairs: Iterator[Pair]) -> dict[str, float]:
    found: dict[str, list[float]] = {}
    for first, second, truth, counted in pairs:
        flow = method(first, second)
        whole = flow_error(flow, truth, counted)
        found.setdefault("flow_epe_px", []).append(whole.endpoint_px)
        found.setdefault("flow_aae_deg", []).append(whole.angular_deg)
        found.setdefault("flow_fl", []).append(whole.outlier_share)
        moving = counted & (np.linalg.norm(truth, axis=-1) > MOVES_PX)
        if moving.any():
            found.setdefault("flow_epe_moving_px", []).append(flow_error(flow, truth, moving).endpoint_px)
    return {name: float(np.mean(values)) for name, values in found.items()}


def _time(method: FlowMethod, pairs: Iterator[Pair]) -> dict[str, float]:
    """After one call to warm up, on one thread."""
    first, second, *_ = next(pairs)
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        method(first, second)
        taken: list[float] = []
        cpu: list[float] = []
        while len(taken) < REPEATS and (not taken or sum(taken) < LONG_S):
            start, cpu_start = perf_counter(), process_time()
            method(first, second)
            taken.append(perf_counter() - start)
            cpu.append(process_time() - cpu_start)
    finally:
        cv2.setNumThreads(threads)
    return {"latency_p50_ms": 1e3 * float(np.median(taken)), "cpu_ms": 1e3 * float(np.median(cpu))}


SUITE = Suite(
    "flow", tuple(SCENES), tuple(FLOW_METHODS), "flow_epe_px", 1.0, cells, axes=AXES, on_data=on_data
)
