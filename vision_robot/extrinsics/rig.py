"""Several cameras calibrated to each other from boards that two or more of them see at a time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision_robot.calibrate.corners import Corners
from vision_robot.calibrate.covariance import NULL
from vision_robot.calibrate.normal_equations import NormalEquations
from vision_robot.calibrate.observations import Observations
from vision_robot.calibrate.refine import schur_complement
from vision_robot.calibrate.result import Rejected
from vision_robot.calibrate.warp import Warp
from vision_robot.calibrate.weighting import trust
from vision_robot.errors import BadParameter, DegenerateViews
from vision_robot.extrinsics.board_pose import board_pose
from vision_robot.extrinsics.rig_links import common_moments, starting_poses
from vision_robot.extrinsics.rig_problem import RigProblem, RigState, settle_rig
from vision_robot.formats.pose import stacked
from vision_robot.geometry import SE3, CameraRig, KnownCamera
from vision_robot.types import Array, Bool, Float, Int

__all__ = ["RigFit", "RigView", "fit_rig"]

FEWEST_CORNERS = 6
CUTOFF = 5.5
NEVER_OUTLYING_PX = 0.1
VIEW_SHARE = 0.3
ROUNDS = 8
RAYLEIGH_MEDIAN = 1.1774


@dataclass(frozen=True)
class RigView:
    """What one camera saw at one moment; `residuals` are projected minus seen [px]."""

    camera: int
    moment: str
    corners: Corners
    residuals: Float[Array, "n 2"]


@dataclass(frozen=True)
class RigFit:
    """A rig with its joint covariance and all that is needed to judge it."""

    rig: CameraRig
    moments: tuple[str, ...]
    rig_from_board: SE3
    views: tuple[RigView, ...]
    warp: Warp
    warp_degree: int
    noise_px: float
    common: Int[Array, "k k"]
    """How many moments each pair of cameras shares; on the diagonal those each camera saw."""
    rejected: tuple[Rejected, ...]
    refined: bool
    iterations: int

    @property
    def rms_px(self) -> float:
        """Root mean square residual per corner, both axes together."""
        squared = np.concatenate([np.sum(view.residuals**2, axis=1) for view in self.views])
        return float(np.sqrt(np.mean(squared)))

    def camera_rms_px(self, index: int) -> float:
        """The same for one camera."""
        own = [np.sum(view.residuals**2, axis=1) for view in self.views if view.camera == index]
        return float(np.sqrt(np.mean(np.concatenate(own)))) if own else float("nan")


def fit_rig(
    names: Sequence[str],
    cameras: Sequence[KnownCamera],
    sightings: Sequence[Mapping[str, Corners]],
    board_points: Float[Array, "m 3"],
    *,
    refine: bool = False,
    warp: int = 0,
    robust: bool = True,
) -> RigFit:
    """Where cameras fixed to each other stand, from one board seen by any of them at each moment.

    Args:
        names: Names of the cameras; the first one's frame is the rig's.
        cameras: Their intrinsics, with covariance where it is known.
        sightings: For each camera, what it saw by the name of the moment. Cameras are linked by the moments
            they share.
        board_points: The board's points [m].
        refine: Estimate the intrinsics too: with their covariance as prior knowledge, or all but the skew
            freely where they have none. Otherwise they are held, and their covariance is carried along.
        warp: Degree of the board's smooth departure from its drawing, one for all cameras.
        robust: Leave out corners and views that noise cannot explain, and name them.

    Raises:
        UnlinkedCameras: Some cameras share no moment with the others.
        Unsynchronised: Two cameras disagree about where the board was at most moments.
        NoConvergence: The descent did not settle.
    """
    if not len(names) == len(cameras) == len(sightings) >= 2:
        counts = (len(names), len(cameras), len(sightings))
        raise BadParameter("rig: counts of names, cameras, sightings", counts, "equal, and two or more")
    usable, rejected = _usable(names, sightings)
    poses = [
        {moment: board_pose(camera.camera, view, board_points) for moment, view in seen.items()}
        for camera, seen in zip(cameras, usable, strict=True)
    ]
    stand, odd = starting_poses(names, cameras, usable, poses, board_points)
    for moment, name, off_px in odd:
        del usable[list(names).index(name)][moment]
        why = f"its board lies {off_px:.1f} px from where the other cameras put it: not the same moment?"
        rejected.append(Rejected(f"{name}: {moment}", why))
    moments = _moments(usable, alone=refine)
    usable = [{m: view for m, view in seen.items() if m in moments} for seen in usable]
    starts = []
    for moment in moments:
        i = max((i for i, seen in enumerate(usable) if moment in seen), key=lambda i: len(usable[i][moment]))
        starts.append(stand[i].inverse() @ poses[i][moment].cam_from_board)
    bend = Warp.smooth(board_points, warp)
    state = RigState(tuple(one.camera for one in cameras), stacked(stand), stacked(starts), bend)
    problem = _problem(cameras, usable, moments, board_points, bend, refine=False)
    end = settle_rig(state, problem)
    problem, end, lost = _cleaned(names, problem, end.state, moments, robust=robust)
    rejected += lost
    if refine:
        unit = 2 * end.equations.cost / max(problem.degrees_of_freedom, 1)
        problem = _with_intrinsics(problem, cameras, bend, unit)
        end = settle_rig(end.state, problem)
        problem, end, lost = _cleaned(names, problem, end.state, moments, robust=robust)
        rejected += lost
    covariance = _covariance(cameras, problem, end.equations, bend, refine=refine)
    state = end.state
    views = _views(problem, state, usable, moments)
    squared = sum(float(np.sum((view.residuals / view.corners.sigma_px[:, None]) ** 2)) for view in views)
    sigmas = np.concatenate([view.corners.sigma_px for view in views])
    noise = np.sqrt(squared / max(problem.degrees_of_freedom, 1)) * float(np.mean(sigmas))
    count = len(names)
    common = np.array([[len(common_moments(usable, i, j)) for j in range(count)] for i in range(count)])
    return RigFit(
        rig=CameraRig(tuple(names), state.cameras, state.cam_from_rig, covariance),
        moments=tuple(moments),
        rig_from_board=state.rig_from_board,
        views=tuple(views),
        warp=state.warp,
        warp_degree=warp,
        noise_px=float(noise),
        common=common,
        rejected=tuple(rejected),
        refined=refine,
        iterations=end.iterations,
    )


def _usable(
    names: Sequence[str], sightings: Sequence[Mapping[str, Corners]]
) -> tuple[list[dict[str, Corners]], list[Rejected]]:
    rejected = [
        Rejected(f"{name}: {moment}", f"{len(view)} corners found, {FEWEST_CORNERS} needed")
        for name, seen in zip(names, sightings, strict=True)
        for moment, view in seen.items()
        if len(view) < FEWEST_CORNERS
    ]
    kept = [{m: view for m, view in seen.items() if len(view) >= FEWEST_CORNERS} for seen in sightings]
    return kept, rejected


def _moments(usable: Sequence[Mapping[str, Corners]], *, alone: bool) -> list[str]:
    """Moments in order of appearance; one camera alone tells nothing but its intrinsics."""
    order = dict.fromkeys(moment for seen in usable for moment in seen)
    least = 1 if alone else 2
    return [moment for moment in order if sum(moment in seen for seen in usable) >= least]


def _problem(
    cameras: Sequence[KnownCamera],
    usable: Sequence[Mapping[str, Corners]],
    moments: Sequence[str],
    board_points: Float[Array, "m 3"],
    warp: Warp,
    *,
    refine: bool,
) -> RigProblem:
    index = {moment: k for k, moment in enumerate(moments)}
    size = sum(len(one.camera.parameters) + 6 for one in cameras) + len(warp)
    return RigProblem(
        seen=tuple(Observations.of(list(seen.values()), board_points) for seen in usable),
        moments=tuple(np.array([index[moment] for moment in seen], dtype=int) for seen in usable),
        moment_count=len(moments),
        free=_free(cameras, len(warp), refine=refine),
        prior=np.zeros((size, size)),
        prior_mean=tuple(one.camera for one in cameras),
    )


def _free(cameras: Sequence[KnownCamera], warps: int, *, refine: bool) -> Bool[Array, "s"]:
    free = []
    for i, one in enumerate(cameras):
        names = one.camera.parameter_names
        own = np.array([name != "skew" for name in names])
        if not one.taken_as_exact:
            own = np.diag(one.covariance) > 0
        free += [own & refine, np.full(6, i > 0)]
    return np.concatenate([*free, np.ones(warps, dtype=bool)])


def _with_intrinsics(
    problem: RigProblem, cameras: Sequence[KnownCamera], warp: Warp, unit: float
) -> RigProblem:
    """The same with free intrinsics, and what is known of them as prior information."""
    prior, first = np.zeros_like(problem.prior), 0
    for one in cameras:
        rows = np.arange(first, first + len(one.camera.parameters))[np.diag(one.covariance) > 0]
        known = one.covariance[np.ix_(rows - first, rows - first)]
        if len(rows):
            scale = 1 / np.sqrt(np.diag(known))
            inverse = np.linalg.pinv(known * scale[:, None] * scale, rcond=1e-12)
            prior[np.ix_(rows, rows)] = unit * inverse * scale[:, None] * scale
        first += len(one.camera.parameters) + 6
    free = _free(cameras, len(warp), refine=True)
    return RigProblem(problem.seen, problem.moments, problem.moment_count, free, prior, problem.prior_mean)


def _cleaned(
    names: Sequence[str], problem: RigProblem, state: RigState, moments: Sequence[str], *, robust: bool
):
    """Leave out what noise cannot explain, weigh the rest by what the residuals say, and settle again."""
    rejected: list[Rejected] = []
    end = None
    for _ in range(ROUNDS):
        lengths = [np.linalg.norm(error, axis=1) for error in problem.residuals(state)]
        every = np.concatenate(
            [length[seen.present] for length, seen in zip(lengths, problem.seen, strict=True)]
        )
        sigmas = np.concatenate([seen.sigma_px[seen.present] for seen in problem.seen])
        believed = trust(every, sigmas)
        if max(believed.scale, believed.floor_px) < 1e-8:
            break
        cleaned, found = [], 0
        for i, (seen, length) in enumerate(zip(problem.seen, lengths, strict=True)):
            sigma = np.where(seen.present, believed.sigma(seen.sigma_px), 1.0)
            keep = seen.present
            if robust:
                far = (length > CUTOFF * sigma) & (length > NEVER_OUTLYING_PX)
                keep = keep & ~far
                crowd = seen.present.sum(axis=1)
                keep &= (keep.sum(axis=1) >= (1 - VIEW_SHARE) * crowd)[:, None]
                lost = seen.present & ~keep
                found += int(lost.sum())
                rejected += _named(names[i], seen, lost, [moments[int(k)] for k in problem.moments[i]])
            weight = np.where(keep, 1 / sigma, 0.0)
            cleaned.append(
                Observations(seen.points, seen.pixels, weight, np.where(keep, seen.ids, -1), seen.sigma_px)
            )
        problem = RigProblem(
            tuple(cleaned),
            problem.moments,
            problem.moment_count,
            problem.free,
            problem.prior,
            problem.prior_mean,
        )
        end = settle_rig(state, problem)
        state = end.state
        if not found:
            return problem, end, rejected
    return problem, end or settle_rig(state, problem), rejected


def _named(name: str, seen: Observations, lost: Array, moments: list[str]) -> list[Rejected]:
    rejected = []
    for view in np.flatnonzero(lost.any(axis=1)).tolist():
        ids = seen.ids[view][lost[view]]
        image = f"{name}: {moments[view]}"
        if lost[view].sum() == seen.present[view].sum():
            why = "too many of its corners lie where no place of the board explains them"
            rejected.append(Rejected(image, why))
        else:
            why = "it lies farther off than noise explains"
            rejected += [Rejected(image, why, corner=int(i)) for i in ids]
    return rejected


def _covariance(
    cameras: Sequence[KnownCamera],
    problem: RigProblem,
    equations: NormalEquations,
    warp: Warp,
    *,
    refine: bool,
) -> Float[Array, "q q"]:
    """Joint covariance of all intrinsics and poses; held intrinsics bring their own along."""
    free = problem.free
    unit = 2 * equations.cost / max(problem.degrees_of_freedom, 1)
    # A moment whose views were all left out says nothing; its block would be singular.
    empty = np.diagonal(equations.pose, axis1=1, axis2=2).max(axis=1) == 0
    pose = np.where(empty[:, None, None], np.eye(6), equations.pose)
    S = schur_complement(replace(equations, pose=pose))
    scale = 1 / np.sqrt(np.maximum(np.diag(equations.shared)[free], 1e-300))
    scaled = S[np.ix_(free, free)] * scale[:, None] * scale
    values, vectors = np.linalg.eigh(scaled)
    weak = np.abs(vectors[:, values < NULL]).max(axis=1, initial=0) > 0.1
    if weak.any():
        index = np.flatnonzero(free)[weak]
        labels = [f"{i}" for i in index]
        raise DegenerateViews(labels, "the equations of the rig leave these unknowns free")
    inverse = (vectors / values) @ vectors.T * scale[:, None] * scale
    size = len(free) - len(warp)
    covariance = np.zeros((len(free), len(free)))
    covariance[np.ix_(free, free)] = unit * inverse
    if not refine:
        held = np.zeros(len(free), dtype=bool)
        known = np.zeros_like(covariance)
        first = 0
        for one in cameras:
            rows = slice(first, first + len(one.camera.parameters))
            held[rows] = True
            known[rows, rows] = one.covariance
            first = rows.stop + 6
        follow = np.zeros_like(covariance)
        follow[np.ix_(free, held)] = -inverse @ S[np.ix_(free, held)]
        carried = follow @ known
        covariance += known + carried + carried.T + carried @ follow.T
    return covariance[:size, :size]


def _views(
    problem: RigProblem, state: RigState, usable: Sequence[Mapping[str, Corners]], moments: list[str]
) -> list[RigView]:
    views = []
    for i, (seen, error) in enumerate(zip(problem.seen, problem.residuals(state), strict=True)):
        for k, (ids, weight) in enumerate(zip(seen.ids, seen.weight, strict=True)):
            there = ids >= 0
            if not there.any():
                continue
            moment = moments[problem.moments[i][k]]
            corners = Corners(
                usable[i][moment].image, ids[there], seen.pixels[k][:, there].T, 1 / weight[there]
            )
            views.append(RigView(i, moment, corners, error[k][:, there].T))
    return views
