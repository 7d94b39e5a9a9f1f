"""mrcal's side of `refinement.py`: needs numpy and mrcal only, so that it may have its own interpreter."""

import json
import sys
import time
from pathlib import Path

import numpy as np


def peak_mb(*, afresh: bool = False) -> float:
    """Peak resident memory of this process [MB], from now on where `afresh`; NaN where it is not told.

    Not getrusage's: that is inherited from the process which started this one.
    """
    try:
        if afresh:
            Path("/proc/self/clear_refs").write_text("5")
        status = Path("/proc/self/status").read_text().splitlines()
    except OSError:
        return float("nan")
    return next(int(line.split()[1]) for line in status if line.startswith("VmHWM:")) / 1024


def main() -> None:
    """Measure mrcal.optimize on a file of corners and print one JSON object."""
    import mrcal  # type: ignore[import-not-found]

    path, repetitions = sys.argv[1], int(sys.argv[2])
    data = np.load(path)
    views = len(data["pixels"])
    rows, columns = int(data["rows"]), int(data["columns"])
    observed = np.ones((views, rows, columns, 3))
    observed[..., :2] = data["pixels"].reshape(views, rows, columns, 2)
    index = np.zeros((views, 3), dtype=np.int32)  # frame, camera, camera's pose: -1, it is the reference
    index[:, 0], index[:, 2] = np.arange(views), -1
    p = data["parameters"]
    intrinsics = np.concatenate([p[:4], p[5:]])[None]  # without skew; k1 k2 p1 p2 k3 as ours
    poses = np.concatenate([data["rotvec"], data["translation"]], axis=1)

    def run() -> float:
        # mrcal writes its answer into what it is given.
        stats = mrcal.optimize(
            intrinsics=intrinsics.copy(),
            rt_cam_ref=np.zeros((0, 6)),
            rt_ref_frame=poses.copy(),
            points=np.zeros((0, 3)),
            observations_board=observed.copy(),
            indices_frame_camintrinsics_camextrinsics=index,
            observations_point=np.zeros((0, 3)),
            indices_point_camintrinsics_camextrinsics=np.zeros((0, 3), dtype=np.int32),
            lensmodel="LENSMODEL_OPENCV5",
            imagersizes=data["size"].astype(np.int32)[None],
            calibration_object_spacing=float(data["square_m"]),
            do_optimize_intrinsics_core=True,
            do_optimize_intrinsics_distortions=True,
            do_optimize_extrinsics=False,
            do_optimize_frames=True,
            do_optimize_calobject_warp=False,
            do_apply_outlier_rejection=False,
            do_apply_regularization=False,
            verbose=False,
        )
        return float(np.sqrt(np.sum(stats["x"] ** 2) / (views * rows * columns)))

    before = peak_mb(afresh=True)
    rms = run()
    grown = peak_mb() - before
    seconds, cpu = [], []
    for _ in range(repetitions):
        wall, busy = time.perf_counter(), time.process_time()
        run()
        seconds.append(time.perf_counter() - wall)
        cpu.append(time.process_time() - busy)
    answer = {"seconds": seconds, "cpu_seconds": cpu, "rms_px": rms, "memory_mb": grown}
    print(json.dumps(answer))


if __name__ == "__main__":
    main()
