"""Peers' inverse kinematics of a PRRRR arm, in an interpreter that has them: called by `ik.py`.

    python ik_peers.py GOALS.npz FOLDER

Writes FOLDER/NAME.npy with joint values (NaN where a solver gave up) and processor seconds by name into
FOLDER/seconds.json. Each is used as its makers recommend for a success near 100 %, restarts included; all
know the joints' limits. Where a library has steps but no solver (Pinocchio, mink) the loop of its own
examples is written around them.
"""

# pyright: basic, reportMissingImports=false, reportAttributeAccessIssue=false, reportCallIssue=false

import importlib.util
import json
import sys
import time
from pathlib import Path

import numpy as np

RESTARTS = 100
STEPS = 200
CLOSE = 1e-6
TRAC_IK_SECONDS = 0.005


def urdf(given):
    """The arm as a URDF file: most peers read nothing else."""
    from scipy.spatial.transform import Rotation

    def origin(pose):
        x = " ".join(f"{v:.17g}" for v in pose[:3, 3])
        angles = " ".join(f"{v:.17g}" for v in Rotation.from_matrix(pose[:3, :3]).as_euler("xyz"))
        return f'<origin xyz="{x}" rpy="{angles}"/>'

    count = len(given["axes"])
    lines = ['<robot name="arm">']
    for k in range(count + 2):
        mass = (
            '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
        )
        lines.append(f'<link name="l{k}">{mass}</link>')
    for k in range(count):
        kind = "prismatic" if given["slides"][k] else "revolute"
        axis = " ".join(f"{v:.17g}" for v in given["axes"][k])
        low, high = given["limits"][k]
        lines.append(
            f'<joint name="j{k}" type="{kind}"><parent link="l{k}"/><child link="l{k + 1}"/>'
            f'{origin(given["links"][k])}<axis xyz="{axis}"/>'
            f'<limit lower="{low:.17g}" upper="{high:.17g}" effort="1" velocity="1"/></joint>'
        )
    lines.append(
        f'<joint name="tool" type="fixed"><parent link="l{count}"/><child link="l{count + 1}"/>'
        f"{origin(given['tool'])}</joint></robot>"
    )
    return "\n".join(lines)


def toolbox(given, _folder, method):
    """Peter Corke's toolbox: its C++ Levenberg-Marquardt (Chan, k = 0.1) or Gauss-Newton, with restarts."""
    import roboticstoolbox as rtb
    from spatialmath import SE3

    parts = []
    for link, axis, slides in zip(given["links"], given["axes"], given["slides"], strict=True):
        parts.append(rtb.ET.SE3(SE3(link, check=False)))
        # All axes of this arm are its frames' own: x, y or z, to either side.
        index = int(np.argmax(np.abs(axis)))
        make = getattr(rtb.ET, ("t" if slides else "R") + "xyz"[index])
        parts.append(make(flip=bool(axis[index] < 0)))
    parts.append(rtb.ET.SE3(SE3(given["tool"], check=False)))
    ets = rtb.ETS(parts)
    ets.qlim = given["limits"].T
    options = {"ilimit": 30, "slimit": RESTARTS, "tol": 1e-12, "joint_limits": True}
    for goal in given["goals"]:
        if method == "LM":
            found = ets.ik_LM(goal, k=0.1, method="chan", **options)
        else:
            found = ets.ik_GN(goal, **options)
        yield np.ravel(found.q) if found.success else None


def trac_ik(given, _folder):
    """TRAC-IK through pytracik, with 5 ms a goal as its authors have it."""
    import pytracik
    from scipy.spatial.transform import Rotation

    text = urdf(given)
    solver = pytracik.TRAC_IK(
        "l0", f"l{len(given['axes']) + 1}", text, TRAC_IK_SECONDS, CLOSE, pytracik.SolveType.Speed
    )
    seed = given["limits"].mean(axis=1)
    for goal in given["goals"]:
        x, q = goal[:3, 3], Rotation.from_matrix(goal[:3, :3]).as_quat()
        found = np.asarray(pytracik.ik(solver, seed, *x, *q))
        yield found[1:] if found[0] >= 0 else None


def ikpy(given, folder):
    """IKPy as its manual uses it: least squares from the middle of the joints' ranges."""
    from ikpy.chain import Chain

    file = folder / "arm.urdf"
    file.write_text(urdf(given), encoding="utf-8")
    count = len(given["axes"])
    chain = Chain.from_urdf_file(
        str(file), base_elements=["l0"], active_links_mask=[False, *[True] * count, False]
    )
    start = np.r_[0, given["limits"].mean(axis=1), 0]
    for goal in given["goals"]:
        found = chain.inverse_kinematics_frame(goal, initial_position=start, orientation_mode="all")
        yield found[1:-1]


def pinocchio(given, _folder):
    """Pinocchio: the damped steps of its inverse-kinematics example, limits held, random restarts."""
    import pinocchio as pin

    model = pin.buildModelFromXML(urdf(given))
    data, frame = model.createData(), model.getFrameId(f"l{len(given['axes']) + 1}")
    low, high = given["limits"].T
    rng = np.random.default_rng(0)
    for goal in given["goals"]:
        wanted, answer = pin.SE3(goal), None
        q = (low + high) / 2
        for _ in range(RESTARTS):
            for _ in range(STEPS):
                pin.framesForwardKinematics(model, data, q)
                off = data.oMf[frame].actInv(wanted)
                error = pin.log(off).vector
                if np.linalg.norm(error) < CLOSE:
                    answer = q
                    break
                jacobian = pin.computeFrameJacobian(model, data, q, frame)
                jacobian = -pin.Jlog6(off.inverse()) @ jacobian
                damped = jacobian @ jacobian.T + 1e-12 * np.eye(6)
                step = -jacobian.T @ np.linalg.solve(damped, error)
                q = np.clip(q + step, low, high)
            if answer is not None:
                break
            q = rng.uniform(low, high)
        yield answer


def mink(given, folder):
    """mink: the loop of its examples around its quadratic programme, limits held, random restarts."""
    import mink
    import mujoco

    file = folder / "arm.urdf"
    file.write_text(urdf(given), encoding="utf-8")
    spec = mujoco.MjSpec.from_file(str(file))
    spec.compiler.fusestatic = False
    spec.body(f"l{len(given['axes']) + 1}").add_site(name="tool")
    configuration = mink.Configuration(spec.compile())
    task = mink.FrameTask("tool", "site", position_cost=1.0, orientation_cost=1.0, lm_damping=1e-9)
    limits = [mink.ConfigurationLimit(configuration.model)]
    low, high = given["limits"].T
    rng = np.random.default_rng(0)
    for goal in given["goals"]:
        task.set_target(mink.SE3.from_matrix(goal))
        answer, start = None, (low + high) / 2
        for _ in range(RESTARTS // 5):
            configuration.update(start)
            for _ in range(STEPS // 5):
                if np.linalg.norm(task.compute_error(configuration)) < CLOSE:
                    answer = configuration.q.copy()
                    break
                velocity = mink.solve_ik(configuration, [task], 1.0, "daqp", limits=limits)
                configuration.integrate_inplace(velocity, 1.0)
            if answer is not None:
                break
            start = rng.uniform(low, high)
        yield answer


PEERS = {
    "roboticstoolbox ik_LM": ("roboticstoolbox", lambda *a: toolbox(*a, "LM")),
    "roboticstoolbox ik_GN": ("roboticstoolbox", lambda *a: toolbox(*a, "GN")),
    "TRAC-IK, 5 ms": ("pytracik", trac_ik),
    "ikpy": ("ikpy", ikpy),
    "Pinocchio, damped steps": ("pinocchio", pinocchio),
    "mink": ("mink", mink),
}
SLOW = {"mink": 10, "ikpy": 10}
"""Peers that solve only every n-th of the goals."""


def main():
    """Run what is installed."""
    given, folder = dict(np.load(sys.argv[1])), Path(sys.argv[2])
    answers = {}
    for name, (package, solve) in PEERS.items():
        if not importlib.util.find_spec(package):
            continue
        some = {**given, "goals": given["goals"][:: SLOW.get(name, 1)]}
        list(solve({**given, "goals": given["goals"][:1]}, folder))  # imports and first calls are not timed
        q, start = [], time.process_time()
        for found in solve(some, folder):
            q.append(np.full(len(given["axes"]), np.nan) if found is None else found)
        seconds = time.process_time() - start
        np.save(folder / f"{name}.npy", np.array(q))
        answers[name] = {"seconds": seconds, "every": SLOW.get(name, 1)}
    (folder / "seconds.json").write_text(json.dumps(answers), encoding="utf-8")


if __name__ == "__main__":
    main()
