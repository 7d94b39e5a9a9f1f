"""Peers' inverse kinematics of a PRRRR arm, in an interpreter that has them: called by `ik.py`.

    python ik_peers.py GOALS.npz FOLDER

Writes FOLDER/NAME.npy with joint values (NaN where a solver gave up) and prints processor seconds by name.
Each is used as its makers recommend for a success near 100 %, restarts included.
"""

import importlib.util
import json
import sys
import time
from pathlib import Path

import numpy as np

RESTARTS = 100


def toolbox(given, method):
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
    q, start = [], time.process_time()
    for goal in given["goals"]:
        options = {"ilimit": 30, "slimit": RESTARTS, "tol": 1e-12, "joint_limits": True}
        found = (
            ets.ik_LM(goal, k=0.1, method="chan", **options) if method == "LM" else ets.ik_GN(goal, **options)
        )
        q.append(found[0] if found[1] else np.full(len(given["axes"]), np.nan))
    return np.array(q), time.process_time() - start


def main():
    """Run what is installed."""
    given, folder = dict(np.load(sys.argv[1])), Path(sys.argv[2])
    seconds = {}
    if importlib.util.find_spec("roboticstoolbox"):
        for method in ("LM", "GN"):
            name = f"roboticstoolbox ik_{method}"
            q, seconds[name] = toolbox(given, method)
            np.save(folder / f"{name}.npy", q)
    print(json.dumps(seconds))


if __name__ == "__main__":
    main()
