"""How often the 95 % intervals hold the truth, for every parameter.

Each run draws another camera, other poses and other noise, calibrates, and asks for each
parameter whether ``estimate ± q sigma`` holds the true value, q being the 97.5 % quantile of
Student's t with the run's degrees of freedom (1.961 for a few thousand). Target: 93 to 97 %.
Runs in which a sigma was stated count; `spread` is the rms of (estimate - truth) / sigma, one where
sigma is honest; the last row
is the chi-square of all parameters together.
"""

import argparse
import warnings

import numpy as np
from synthetic import some_camera, some_views
from table import markdown, shown, wilson

from vision_robot.calibrate import Settings, calibrate
from vision_robot.errors import VisionRobotError


def asked() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--model", default="brown5")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--views", type=int, default=20)
    parser.add_argument("--noise", type=float, default=0.2, help="one sigma of a corner per axis [px]")
    parser.add_argument("--warp", type=int, default=0)
    parser.add_argument("--not-robust", action="store_true", help="without outlier rejection")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="three runs: only to see that it runs")
    return parser.parse_args()


def main() -> None:
    """Run and print."""
    from scipy.stats import chi2, t

    options = asked()
    runs = 3 if options.quick else options.runs
    settings = Settings(model=options.model, warp=options.warp, robust=not options.not_robust)
    names = [name for name, free in zip(settings.names, settings.free, strict=True) if free]
    z, noise, joint, left_out, failed = [], [], [], 0, []
    q = 0.0
    for seed in range(runs):
        camera = some_camera(np.random.default_rng([seed, 4]), options.model)
        made = some_views(camera, options.views, seed=seed, noise_px=options.noise)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                result = calibrate(made.corners, made.board, made.size, settings)
        except VisionRobotError as error:
            failed.append(f"seed {seed}: {error}")
            continue
        free = np.flatnonzero(settings.free)
        error = (result.camera.parameters - camera.parameters)[free]
        C = result.covariance.intrinsics[np.ix_(free, free)]
        stated = np.array([name in result.sigma for name in names])
        scaled = np.where(stated, error / np.sqrt(np.diag(C)), np.nan)
        z.append(scaled)
        if stated.all():
            scale = 1 / np.sqrt(np.diag(C))
            joint.append(float(scaled @ np.linalg.solve(C * scale[:, None] * scale, scaled)))
        noise.append(result.noise_px / options.noise)
        left_out += sum(1 if r.corner is not None else len(made.board) for r in result.rejected)
        q = float(t.ppf(0.975, result.degrees_of_freedom))
    z = np.array(z)
    chi = (np.sqrt(np.abs(joint)), float(np.sqrt(chi2.ppf(0.95, len(names)))))
    rows, figures = [], []
    for name, values, limit in [*zip(names, z.T, [q] * len(names), strict=True), ("all, chi-square", *chi)]:
        told = values[np.isfinite(values)]
        hits, n = int((np.abs(told) <= limit).sum()), len(told)
        if not n:
            rows.append([name, 0, "–", "–", "–"])
            continue
        low, high = wilson(hits, n)
        spread = float(np.sqrt(np.mean(told**2) / (1 if name in names else len(names))))
        share = f"{100 * hits / n:.1f} %"
        rows.append([name, n, share, f"[{100 * low:.1f}, {100 * high:.1f}]", f"{spread:.3f}"])
        figure = {"parameter": name, "stated": n, "share": hits / n, "low": low, "high": high}
        figures.append({**figure, "spread": spread})
    table = markdown(("parameter", "runs", "held the truth", "95 % interval", "spread"), rows)
    shares = [figure["share"] for figure in figures[:-1]]
    table += (
        f"\n\n{options.model}, {len(z)} runs of {options.views} views, {options.noise} px noise; "
        f"all parameters {100 * np.mean(shares):.2f} %; noise found / true {np.mean(noise):.4f}; "
        f"{left_out} corners left out; {len(failed)} runs failed."
    )
    table += "".join(f"\n{line}" for line in failed)
    print(shown("vr.benchmark.coverage/1", figures, table, as_json=options.json))


if __name__ == "__main__":
    main()
