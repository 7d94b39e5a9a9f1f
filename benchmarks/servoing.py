"""How few looks, how wrong a camera and how late a picture do the laws of servoing bear?

looks: number of looks until the tool is within 0.5 mm of the thing and stays there, for our laws and
beside them ViSP's published ones (`servoing_visp.py`), with a camera knocked by 1 degree and 5 mm: a thing
as high as the label, where all can get there, and a thing on the table, where coinciding in the picture
is not enough. capture: share of runs that end within 1 mm, by how far the camera was turned and shifted
and how wrong its focal length is. margins: critical gain and latency by eigenvalues, and whether the loop
itself settles at 0.7 and 1.3 times it. These three are kinematic: true geometry, a label seen with 0.1 px
noise, no forces. physics: points of the capture map in MuJoCo, whole episodes.
"""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from servoing_visp import GAINS, JACOBIANS, visp_law
from table import markdown, shown, wilson

from vision_robot.errors import LostSight, ServoAstray, VisionRobotError
from vision_robot.geometry import SE3, WorkPlane
from vision_robot.pick.closed_loop import LAWS
from vision_robot.pick.episodes import Plan, run_episode
from vision_robot.pick.servo.continuous import position_based
from vision_robot.pick.servo.kinematic import KinematicStage
from vision_robot.pick.servo.margins import critical_gain_per_s, critical_latency_s, mismatch
from vision_robot.pick.servo.settings import Servoing
from vision_robot.pick.sighting import Sighting
from vision_robot.pick.world import ordinary_world

WORLD = ordinary_world()
CAMERA = WORLD.view.camera
CALIBRATED = WorkPlane.exact(CAMERA, WORLD.view.cam_from_station)
PERIOD_S = 1 / 30
THING_M, LABEL_OVER_TOOL_M = 0.005, 0.06
NEAR_M, CAUGHT_M = 5e-4, 1e-3

Law = Callable[[KinematicStage, Sighting, Servoing], object]


@dataclass(frozen=True)
class Knock:
    """How wrong a camera is: sizes, each in a direction drawn anew."""

    turn_deg: float = 0.0
    shift_mm: float = 0.0
    focal: float = 0.0
    """Share by which the believed focal length is too large."""

    def planes(self, rng: np.random.Generator) -> tuple[WorkPlane, WorkPlane]:
        """Believed and true."""
        axis, way = (one / np.linalg.norm(one) for one in rng.normal(size=(2, 3)))
        knock = SE3.from_rotvec(np.radians(self.turn_deg) * axis, 1e-3 * self.shift_mm * way)
        true = WorkPlane.exact(CAMERA, knock @ WORLD.view.cam_from_station)
        lens = replace(CAMERA, fx=CAMERA.fx * (1 + self.focal), fy=CAMERA.fy * (1 + self.focal))
        return WorkPlane.exact(lens, WORLD.view.cam_from_station), true


def run(law: Law, knock: Knock, seed: int, how: Servoing, height_m: float = THING_M) -> KinematicStage | None:
    """One run with a thing at a random place; None where the camera does not see the thing."""
    rng = np.random.default_rng([seed, 7])
    believed, true = knock.planes(rng)
    place = rng.uniform((-0.1, -0.13), (0.08, 0.13))
    pixel = true.pixels(place[None], z_m=height_m)
    seen, _ = believed.measure(pixel, z_m=height_m)
    inside = (pixel >= 0).all() and (pixel[0] <= [CAMERA.width - 1, CAMERA.height - 1]).all()
    if not inside or not np.isfinite(seen).all():
        return None
    over = LABEL_OVER_TOOL_M if height_m == THING_M else -how.heights_m[-1]
    stage = KinematicStage(believed, true, place, over, seed=seed)
    stage.go(Sighting(seen[0], np.zeros((2, 2)), 0.0, height_m), how.heights_m[0])
    found = law(stage, Sighting(seen[0], np.zeros((2, 2)), 0.0, height_m), how)
    if isinstance(found, Sighting):
        # The arm goes where it is told: what the law answers is where the tool ends.
        stage.go(found, how.heights_m[-1])
        stage.note(0.0)
    return stage


def looks_to(stage: KinematicStage, near_m: float = NEAR_M) -> float:
    """After how many looks the true error stayed below `near_m`; infinite where it did not."""
    off = np.array([look.true_m for look in stage.looks])
    beyond = np.flatnonzero(off > near_m)
    last = int(beyond[-1]) + 1 if len(beyond) else 0
    return float(last) if last < len(off) else np.inf


# ------------------------------------------------------------------ parts


def looks(runs: int) -> tuple[object, str]:
    """Ours and ViSP's."""
    rivals: dict[str, Law] = dict(LAWS)
    for gain in GAINS:
        for jacobian in JACOBIANS:
            rivals[f"ViSP, {gain} gain, L {jacobian}"] = visp_law(GAINS[gain], JACOBIANS[jacobian])
    figures, rows = [], []
    for name, law in rivals.items():
        row: list[object] = [name]
        for where, height, heights in (
            ("at the label's height", 0.085, (0.02,)),
            ("on the table", THING_M, Servoing().heights_m),
        ):
            how = Servoing(heights_m=heights)
            counts = np.array([looks_to(_run(law, seed, how, height)) for seed in range(runs)])
            there = np.isfinite(counts)
            median = float(np.median(counts[there])) if there.mean() > 0.5 else None
            figures.append(
                {"law": name, "thing": where, "median_looks": median, "there": int(there.sum()), "runs": runs}
            )
            row += ["-" if median is None else f"{median:.0f}", f"{there.sum()} of {runs}"]
        rows.append(row)
    columns = (
        "law",
        "looks, thing at the label's height",
        "got there",
        "looks, thing on the table",
        "got there",
    )
    return figures, markdown(columns, rows)


def _run(law: Law, seed: int, how: Servoing, height: float) -> KinematicStage:
    for again in range(20):
        stage = run(law, Knock(1.0, 5.0), 1000 * again + seed, how, height)
        if stage is not None:
            return stage
    raise AssertionError("a camera knocked by a degree sees the table")


CAPTURE = [
    *(Knock(turn_deg=turn) for turn in (0.5, 1, 2, 5, 10, 15)),
    *(Knock(shift_mm=shift) for shift in (5, 20, 50, 100)),
    *(Knock(focal=focal) for focal in (-0.2, -0.05, 0.05, 0.2)),
    Knock(1, 5),
    Knock(5, 50, 0.05),
]


def capture(runs: int, knocks: Sequence[Knock] = CAPTURE) -> tuple[object, str]:
    """Share of runs that end within a millimetre."""
    figures, rows = [], []
    for knock in knocks if runs > 1 else knocks[-2:]:
        row: list[object] = [f"{knock.turn_deg:g} deg, {knock.shift_mm:g} mm, {100 * knock.focal:+g} %"]
        for name, law in LAWS.items():
            ends = [_end_m(law, knock, seed) for seed in range(runs)]
            known = np.array([end for end in ends if end is not None])
            caught, n = int((known < CAUGHT_M).sum()), len(known)
            low, high = wilson(caught, n) if n else (np.nan, np.nan)
            median = float(np.median(known[np.isfinite(known)])) if np.isfinite(known).any() else None
            figures.append(
                {
                    "law": name,
                    **vars(knock),
                    "caught": caught,
                    "runs": n,
                    "interval": [low, high],
                    "median_m": median,
                }
            )
            row.append(f"{caught} of {n}, {'-' if median is None else f'{1e3 * median:.2f} mm'}")
        rows.append(row)
    columns = ("camera turned, shifted, focal length", *(f"{name}: within 1 mm, median" for name in LAWS))
    return figures, markdown(columns, rows)


def _end_m(law: Law, knock: Knock, seed: int) -> float | None:
    try:
        stage = run(law, knock, seed, Servoing())
    except (LostSight, ServoAstray):
        return np.inf
    return None if stage is None else stage.looks[-1].true_m


LATENCIES_S = (0.1, 0.0, 0.2, 0.4)
SHARES = (0.7, 1.3)
"""Of the critical gain, at which the loop itself is run."""


def margins(count: int) -> tuple[object, str]:
    """Critical gains and latencies."""
    rolled = SE3.from_rotvec(np.array([0, 0, np.radians(10)]), np.zeros(3))
    lens = replace(CAMERA, fx=0.8 * CAMERA.fx, fy=0.8 * CAMERA.fy)
    over = np.array([0.0, 0.0, THING_M + 0.02 + LABEL_OVER_TOOL_M])
    cameras = {
        "exact": (CALIBRATED, CALIBRATED),
        "turned by 10 deg about its axis": (
            CALIBRATED,
            WorkPlane.exact(CAMERA, rolled @ CALIBRATED.cam_from_station),
        ),
        "focal length 20 % too small": (WorkPlane.exact(lens, CALIBRATED.cam_from_station), CALIBRATED),
    }
    figures, rows = [], []
    for camera, (believed, true) in cameras.items():
        off = mismatch(believed, true, over)
        for latency in LATENCIES_S[:count]:
            plain, mended = (
                critical_gain_per_s(latency, PERIOD_S, off, compensate=one) for one in (False, True)
            )
            late = [
                critical_latency_s(Servoing().gain_per_s, PERIOD_S, off, compensate=one)
                for one in (False, True)
            ]
            calm = [_settles(believed, true, latency, share * plain) for share in SHARES]
            figures.append(
                {
                    "camera": camera,
                    "latency_s": latency,
                    "critical_gain_per_s": _number(plain),
                    "critical_gain_compensated_per_s": _number(mended),
                    "critical_latency_s": _number(late[0]),
                    "critical_latency_compensated_s": _number(late[1]),
                    "settles_at_shares": dict(zip(map(str, SHARES), calm, strict=True)),
                }
            )
            said = " / ".join("-" if one is None else "yes" if one else "no" for one in calm)
            rows.append([camera, f"{1e3 * latency:.0f} ms", *map(_shown, (plain, mended, *late)), said])
    columns = (
        "camera",
        "latency",
        "critical gain [1/s]",
        "compensated",
        f"critical latency at {Servoing().gain_per_s:g}/s [s]",
        "compensated",
        "settles at {} / {} of it".format(*SHARES),
    )
    return figures, markdown(columns, rows)


def _settles(believed: WorkPlane, true: WorkPlane, latency_s: float, gain_per_s: float) -> bool | None:
    """Whether the loop itself calms down; None where a whole step in one picture still does."""
    if not gain_per_s * PERIOD_S <= 1:
        return None
    how = Servoing(
        gain_per_s=gain_per_s, compensate=False, heights_m=(0.02,), enough_m=1.0, most_seconds=15.0
    )
    # A shift on top gives the loop something to do where the camera is exact.
    aside = SE3(np.eye(3), np.array([0.01, 0.0, 0.0])) @ true.cam_from_station
    shifted = WorkPlane.exact(true.camera, aside)
    stage = KinematicStage(
        believed, shifted, np.zeros(2), LABEL_OVER_TOOL_M, noise_px=0.02, latency_s=latency_s
    )
    seen, _ = believed.measure(true.pixels(np.zeros((1, 2)), z_m=THING_M), z_m=THING_M)
    try:
        position_based(stage, Sighting(seen[0], np.zeros((2, 2)), 0.0, THING_M), how)
    except (LostSight, ServoAstray):
        return False
    return True


def _number(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _shown(value: float) -> str:
    return f"{value:.2g}" if np.isfinite(value) else "any"


def physics(runs: int) -> tuple[object, str]:
    """Whole episodes of look-move-look in MuJoCo."""
    figures, rows = [], []
    for knock in (Knock(1, 5), Knock(3, 20), Knock(5, 50)):
        ends, held = [], 0
        for seed in range(runs):
            rng = np.random.default_rng([seed, 8])
            _, true = knock.planes(rng)
            moved = true.cam_from_station @ WORLD.view.cam_from_station.inverse()
            try:
                episode = run_episode(
                    replace(WORLD, knock=moved), Plan(options={"color": "red"}, loop="look-move-look"), seed
                )
            except VisionRobotError:
                continue
            held += bool(episode.lifted)
            if episode.closing is not None:
                ends.append(episode.closing.position_m)
        low, high = wilson(held, runs)
        median = float(np.median(ends)) if ends else None
        figures.append(
            {**vars(knock), "lifted": held, "runs": runs, "interval": [low, high], "median_m": median}
        )
        shown_median = "-" if median is None else f"{1e3 * median:.2f} mm"
        rows.append([f"{knock.turn_deg:g} deg, {knock.shift_mm:g} mm", f"{held} of {runs}", shown_median])
    return figures, markdown(("camera turned, shifted", "lifted", "median error at closing"), rows)


PARTS: dict[str, tuple[Callable[[int], tuple[object, str]], int]] = {
    "looks": (looks, 40),
    "capture": (capture, 40),
    "margins": (margins, len(LATENCIES_S)),
    "physics": (physics, 10),
}


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("parts", nargs="*", default=list(PARTS), help=", ".join(PARTS))
    parser.add_argument("--runs", type=int, help="of each cell")
    parser.add_argument("--json", action="store_true")
    parser.add_argument(
        "--quick", action="store_true", help="one run of each, no physics: only to see that it runs"
    )
    options = parser.parse_args()
    figures, tables = {}, []
    for part in options.parts:
        if options.quick and part == "physics":
            continue
        measure, usual = PARTS[part]
        figures[part], table = measure(1 if options.quick else options.runs or usual)
        tables.append(f"### {part}\n\n{table}")
    print(shown("vr.benchmark.servoing/1", figures, "\n\n".join(tables), as_json=options.json))


if __name__ == "__main__":
    main()
