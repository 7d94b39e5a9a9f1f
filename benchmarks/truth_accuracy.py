"""How true the truth is: outlines, flow and grasps of the rendered cell against independent judges.

- disc: centroid of an unhidden disc, flat and tilted, against the centre of its ellipse in closed form
- counted: the mean of the mask's pixels against that same closed form, for comparison
- flow: true flow against rays cast through the exact geometry, moved and projected, for three lenses
- grasp: rods grasped at many yaws and off their middle, lifted by 4 cm and held 1 s, by friction alone
"""

import argparse

import numpy as np
from table import markdown, shown

from vision_robot.geometry import SE3, Camera
from vision_robot.sim.cell import Cell
from vision_robot.sim.cell_design import ArmMount, CellDesign, Item, Lights, look_at
from vision_robot.sim.gl import load_mujoco
from vision_robot.sim.paths import Circle, Straight
from vision_robot.sim.true_flow import true_flow
from vision_robot.sim.truth import TruthFrame, TruthRenderer
from vision_robot.types import Array, Float

PINHOLE = Camera(640, 480, 600, 600, 319.5, 239.5)
LENSES = {
    "pinhole": PINHOLE,
    "brown5": Camera(640, 480, 600, 590, 330, 230, 1.0, "brown5", (-0.2, 0.05, 0.001, -0.001, 0.0)),
    "fisheye": Camera(640, 480, 250, 250, 320, 240, 0.0, "fisheye", (0.01, 0.0, 0.0, 0.0)),
}
PLAIN = Lights(shadows=False)
UPPER_M, FORE_M = 0.30, 0.25


def discs(count: int) -> list[dict]:
    """Discs at random places and tilts of the camera."""
    rng = np.random.default_rng(0)
    exact, counted, middle = [], [], []
    for _ in range(count):
        x, y, tilt = rng.uniform(-0.15, 0.15), rng.uniform(-0.15, 0.15), rng.uniform(0, 0.7)
        item = Item("disc", "disc", (0.06, 0.001), x_m=x, y_m=y, fixed=True)
        view = look_at(PINHOLE, (-0.8 * np.sin(tilt), 0.0, 0.8 * np.cos(tilt)))
        with TruthRenderer(Cell(CellDesign(items=(item,), lights=PLAIN)), view) as eye:
            frame = eye.frame()
        pose = view.cam_from_station @ SE3(np.eye(3), np.array([x, y, 0.0005]))
        H = PINHOLE.K @ np.stack([pose.rotation[:, 0], pose.rotation[:, 1], pose.translation], axis=1)
        dual = H @ np.diag([0.03**2, 0.03**2, -1.0]) @ H.T
        centre = dual[:2, 2] / dual[2, 2]
        v, u = np.nonzero(frame.ids == 1)
        exact.append(np.linalg.norm(frame.objects.centroid_px[0] - centre))
        counted.append(np.linalg.norm([u.mean() - centre[0], v.mean() - centre[1]]))
        middle.append(np.linalg.norm(frame.objects.centre_px[0] - centre))
    return [
        row("disc: our centroid to the ellipse's centre", exact, "px"),
        row("disc: mean of the mask's pixels to it", counted, "px"),
        row("disc: picture of the disc's middle to it (perspective)", middle, "px"),
    ]


def flows(points: int) -> list[dict]:
    """Endpoint errors of true flow over 0.2 s."""
    items = (
        Item("disc", "disc", (0.06, 0.01), path=Straight((-0.1, -0.1, 0, 0), (0.1, 0.2, 0, 0))),
        Item("pencil", path=Straight((0, 0, 0, 0), (0.05, 0.02, 0, 1.0))),
        Item("rod", "rod", path=Straight((0.05, -0.02, 0.02, 1), (-0.08, 0.05, 0, -1.0))),
        Item("box", "box", (0.04, 0.03, 0.03), path=Circle((0.02, 0.05), 0.08, 1.0)),
    )
    rows = []
    for name, camera in LENSES.items():
        cell = Cell(CellDesign(items=items, lights=PLAIN))
        view = look_at(camera, (0.05, 0.1, 0.3 if name == "fisheye" else 0.7))
        with TruthRenderer(cell, view, depth=True) as eye:
            cell.at(0.5)
            before = eye.frame()
            cell.at(0.7)
            after = eye.frame()
        flow = true_flow(before, after).flow_px
        v, u = np.nonzero((before.ids > 0) & np.isfinite(flow[..., 0]))
        some = np.random.default_rng(1).permutation(len(u))[:points]
        pixels = np.stack([u[some], v[some]], axis=1)
        exact, bodies = cast(cell, before, after, pixels)
        same = bodies + 1 == before.bodies[v[some], u[some]]
        rows.append(
            row(
                f"flow, {name}: endpoint error",
                np.linalg.norm(flow[v[some], u[some]] - exact, axis=1)[same],
                "px",
            )
        )
    return rows


def cast(
    cell: Cell, before: TruthFrame, after: TruthFrame, pixels: Float[Array, "n 2"]
) -> tuple[Float[Array, "n 2"], Array]:
    """Flow of the points that rays through the pixels meet, and the body each belongs to."""
    mj, groups = load_mujoco(), np.array([1, 1, 1, 0, 0, 0], dtype=np.uint8)
    cell.at(before.time_s)
    base_from_cam = cell.base_from_station @ before.cam_from_station.inverse()
    points, bodies = [], []
    for ray in before.camera.unproject(pixels.astype(float)) @ base_from_cam.rotation.T:
        geom = np.zeros(1, dtype=np.int32)
        reach = mj.mj_ray(cell.model, cell.data, base_from_cam.translation, ray, groups, 1, -1, geom, None)
        bodies.append(int(cell.model.geom_bodyid[geom[0]]))
        R, t = cell.data.xmat[bodies[-1]].reshape(3, 3), cell.data.xpos[bodies[-1]]
        points.append(R.T @ (base_from_cam.translation + reach * ray - t))
    cell.at(after.time_s)
    R, t = cell.data.xmat[bodies].reshape(-1, 3, 3), cell.data.xpos[bodies]
    moved = (R @ np.array(points)[..., None])[..., 0] + t
    in_cam = (after.cam_from_station @ cell.base_from_station.inverse()).apply(moved)
    return after.camera.project(in_cam) - pixels, np.array(bodies)


def grasps(count: int) -> list[dict]:
    """Lifts at random places, yaws and distances from the middle."""
    rng = np.random.default_rng(2)
    lifted, creep, turn = [], [], []
    for i in range(count):
        shape = ("rod", "hexagon", "pencil")[i % 3]
        x, y, yaw = rng.uniform(-0.1, 0.1), rng.uniform(-0.12, 0.12), rng.uniform(0, np.pi)
        up, crept, turned = lift(shape, x, y, yaw, along=rng.uniform(-0.025, 0.025))
        lifted.append(up)
        creep.append(1e3 * crept)
        turn.append(np.degrees(turned))
    share = {
        "what": "grasp: lifted by 4 cm and held 1 s",
        "mean": float(np.mean(lifted)),
        "n": count,
        "unit": "share",
    }
    return [
        {**share, "p99": float("nan"), "max": float("nan")},
        row("grasp: creep in the fingers within 1 s", creep, "mm"),
        row("grasp: turn in the fingers within 1 s", turn, "deg"),
    ]


def lift(shape: str, x: float, y: float, yaw: float, *, along: float) -> tuple[bool, float, float]:
    """Whether a rod was held, and how far it crept [m] and turned [rad] in the fingers."""
    cell = Cell(CellDesign(items=(Item("it", shape, x_m=x, y_m=y, yaw_rad=yaw),), arm=ArmMount()))
    grip = cell.station_from("it").apply(np.array([[along, 0, 0]]))[0]

    def reach(height: float) -> Float[Array, "5"]:
        place = cell.base_from_station.apply(np.array([[grip[0], grip[1], height]]))[0]
        return tool_down(place, yaw - np.pi / 2)

    cell.pose_arm(reach(0.05), opening_m=0.03)
    cell.follow(np.array([0, 0.6]), np.array([reach(0.05), reach(0.0045)]))
    cell.advance(0.8, opening_m=cell.opening_limits_m[0])
    before = cell.station_from("it").translation[2]
    cell.follow(np.array([0, 0.6]), np.array([reach(0.0045), reach(0.0445)]))
    cell.advance(0.2)
    held = cell.station_from_tool.inverse() @ cell.station_from("it")
    cell.advance(1.0)
    crept = (cell.station_from_tool.inverse() @ cell.station_from("it")) @ held.inverse()
    up = cell.station_from("it").translation[2] - before > 0.0395
    return bool(up), float(np.linalg.norm(crept.translation)), float(np.linalg.norm(crept.rotvec()))


def tool_down(place: Float[Array, "3"], yaw: float) -> Float[Array, "5"]:
    """Joints of the project's own arm for a tool that points straight down, in closed form."""
    x, y, z = place
    elbow = np.arccos((x * x + y * y - UPPER_M**2 - FORE_M**2) / (2 * UPPER_M * FORE_M))
    shoulder = np.arctan2(y, x) - np.arctan2(FORE_M * np.sin(elbow), UPPER_M + FORE_M * np.cos(elbow))
    return np.array([z - 0.05, shoulder, elbow, 0.0, (shoulder + elbow - yaw + np.pi) % (2 * np.pi) - np.pi])


def row(what: str, values: Float[Array, "n"] | list[float], unit: str) -> dict:
    """Mean, 99th percentile and largest of some errors."""
    values = np.asarray(values)
    return {
        "what": what,
        "mean": float(values.mean()),
        "p99": float(np.quantile(values, 0.99)),
        "max": float(values.max()),
        "n": len(values),
        "unit": unit,
    }


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="few of each: only to see that it runs")
    options = parser.parse_args()
    few = options.quick
    figures = discs(2 if few else 60) + flows(20 if few else 3000) + grasps(1 if few else 60)
    rows = [
        (
            f["what"],
            *("" if np.isnan(f[k]) else f"{f[k]:.2g}" for k in ("mean", "p99", "max")),
            f["unit"],
            f["n"],
        )
        for f in figures
    ]
    table = markdown(("what", "mean", "99 %", "max", "unit", "n"), rows)
    print(shown("vr.benchmark.truth_accuracy/1", figures, table, as_json=options.json))


if __name__ == "__main__":
    main()
