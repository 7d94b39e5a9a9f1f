"""The page of a rig of cameras."""

import numpy as np

from vision_robot.calibrate.boards import Board
from vision_robot.evaluate.rig import RigError
from vision_robot.extrinsics.rig import RigFit
from vision_robot.extrinsics.rig_held_out import BoardError
from vision_robot.geometry import SE3
from vision_robot.report.ellipse_figure import ellipses
from vision_robot.report.page import Facts, Figure, Figures, Footer, Page, Paragraph, Remarks, Section, Table
from vision_robot.report.pixel_figures import residual_arrows, scatter_rings
from vision_robot.report.quantity import compact, with_sigma
from vision_robot.report.space_figure import InSpace, space_figure
from vision_robot.report.versions import versions

__all__ = ["rig_page"]

MOST_BOARDS = 40


def rig_page(
    fit: RigFit,
    *,
    held_out: BoardError | None = None,
    board: Board | None = None,
    against: RigError | None = None,
    command: str = "",
    seed: int | None = None,
) -> Page:
    """Everything needed to judge a rig, as one page."""
    sections = [
        Section("Result", (_facts(fit, held_out, against), Remarks(tuple(_remarks(fit, held_out, against))))),
        Section("Cameras", (_cameras(fit), _links(fit))),
        Section("In space", (Figures((_space(fit, board),)),)),
        Section("Residuals", (Figures(tuple(_residuals(fit))),)),
        Section("Triangulated points", (Figures(tuple(_points(fit, held_out, against))), Paragraph(ABOUT))),
    ]
    if fit.rejected:
        rows = tuple(
            (one.image, "view" if one.corner is None else f"corner {one.corner}", one.reason)
            for one in fit.rejected[:60]
        )
        sections.append(
            Section("Left out", (Table(("picture", "what", "reason"), rows, "Left out of the rig."),))
        )
    target = f" of a {board.description}" if board else ""
    return Page(
        title="Rig of cameras",
        summary=f"{len(fit.rig)} cameras calibrated to each other from {len(fit.views)} views{target} at "
        f"{len(fit.moments)} moments. The residuals are {compact(fit.rms_px)} px rms per corner.",
        sections=tuple(sections),
        footer=Footer(versions=versions(), seed=seed, command=command),
    )


ABOUT = (
    "Ellipses show a point at the middle of each board, as all cameras together would measure it "
    "with the noise found: "
    "noise and the rig's own uncertainty, intrinsics among it. Errors in the size of the print are not in it."
)


def _facts(fit: RigFit, held_out: BoardError | None, against: RigError | None) -> Facts:
    items = [
        ("cameras", str(len(fit.rig)), ", ".join(fit.rig.names)),
        ("moments", str(len(fit.moments)), f"{len(fit.views)} views"),
        ("rms residual", f"{compact(fit.rms_px)} px", "per corner, both axes together"),
        ("noise σ", f"{compact(fit.noise_px)} px", "per corner and axis"),
        (
            "intrinsics",
            "estimated" if fit.refined else "held",
            "in the same bundle" if fit.refined else "as given",
        ),
    ]
    if held_out:
        items.append(
            (
                "boards held out",
                f"{compact(1000 * held_out.rms_m)} mm",
                f"rms over their drawing when triangulated; at most "
                f"{compact(1000 * held_out.foretold_m)} mm foretold",
            )
        )
    if against:
        items.append(
            (
                "points, to the truth",
                f"{compact(1000 * against.rms_m)} mm",
                f"rms of {len(against.errors)}; foretold {compact(1000 * against.foretold_m)} mm",
            )
        )
    return Facts(tuple(items))


def _remarks(fit: RigFit, held_out: BoardError | None, against: RigError | None) -> list[tuple[str, str]]:
    said = []
    off = fit.common[~np.eye(len(fit.rig), dtype=bool)]
    if off.size and off.min() == 0:
        said.append(("note", "Some pairs of cameras share no moment; they are linked through others."))
    if off.size and 0 < off[off > 0].min() < 5:
        said.append(
            ("caution", "A pair of cameras shares fewer than five moments: its place rests on few pictures.")
        )
    if held_out:
        good = held_out.rms_m <= 1.2 * held_out.foretold_m
        text = f"Boards that took no part are measured to {compact(1000 * held_out.rms_m)} mm rms"
        end = (
            "as foretold."
            if good
            else f"where at most {compact(1000 * held_out.foretold_m)} mm was foretold."
        )
        said.append(("good" if good else "caution", f"{text}, {end}"))
    if against:
        said.append(
            (
                "note",
                f"Points miss the truth by {against.ratio:.2f} times their own foretold sigma, one "
                f"rig's errors "
                "being shared by all its points.",
            ),
        )
    return said


def _cameras(fit: RigFit) -> Table:
    rows = []
    stand = fit.rig.cam_from_rig
    for i, name in enumerate(fit.rig.names):
        sigma = np.sqrt(np.diag(fit.rig.pose_covariance(i)))
        centre, spread = 1000 * stand.inverse().translation[i], 1000 * float(sigma[3:].max())
        rows.append(
            (
                name,
                *(with_sigma(float(part), spread)[0] for part in centre),
                compact(spread, 2),
                f"{np.degrees(np.linalg.norm(stand[i].rotvec())):.3f}",
                compact(float(np.degrees(sigma[:3]).max()), 2),
                f"{fit.camera_rms_px(i):.3f}",
            )
        )
    return Table(
        ("camera", "x [mm]", "y [mm]", "z [mm]", "σ [mm]", "turn [°]", "σ [°]", "rms [px]"),
        tuple(rows),
        "Where each camera stands in the rig's frame, which is the first one's; sigma is the "
        "largest along or about "
        "an axis.",
        frozenset({1, 2, 3, 4, 5, 6, 7}),
    )


def _links(fit: RigFit) -> Table:
    rows = tuple(
        (name, *(str(int(n)) for n in row)) for name, row in zip(fit.rig.names, fit.common, strict=True)
    )
    return Table(
        ("seen by", *fit.rig.names),
        rows,
        "Moments at which two cameras saw the board together; on the diagonal those of one.",
        frozenset(range(1, len(fit.rig) + 1)),
    )


def _space(fit: RigFit, board: Board | None) -> Figure:
    back = fit.rig.cam_from_rig.inverse()
    every = max(1, -(-len(fit.moments) // MOST_BOARDS))
    outlines = []
    if board is not None:
        (width, height), (x, y) = board.size_m, board.origin_m
        edge = np.array([[-x, -y, 0], [width - x, -y, 0], [width - x, height - y, 0], [-x, height - y, 0]])
        outlines = [fit.rig_from_board[i].apply(edge) for i in range(0, len(fit.moments), every)]
    scene = InSpace(
        cameras=[(name, fit.rig.cameras[i], back[i]) for i, name in enumerate(fit.rig.names)],
        frames=[("", SE3.identity())],
        outlines=[_upright(one) for one in outlines],
    )
    turned = InSpace(
        cameras=[(name, camera, _turn() @ pose) for name, camera, pose in scene.cameras],
        frames=[("", _turn())],
        outlines=scene.outlines,
    )
    return space_figure(
        turned,
        alt="Cameras and boards in space",
        caption="The cameras and every place of the board, laid out upright: z of the drawing is "
        "up, against the "
        "first camera's y.",
    )


def _turn() -> SE3:
    """Camera axes (x right, y down, z forward) as (right, forward, up)."""
    return SE3(np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]), np.zeros(3))


def _upright(points: np.ndarray) -> np.ndarray:
    return _turn().apply(points)


def _residuals(fit: RigFit) -> list[Figure]:
    figures = []
    for i, name in enumerate(fit.rig.names):
        own = [view for view in fit.views if view.camera == i]
        if own:
            pixels = np.concatenate([view.corners.pixels for view in own])
            residuals = np.concatenate([view.residuals for view in own])
            figures.append(residual_arrows(fit.rig.cameras[i], pixels, residuals, title=name))
    return figures


def _points(fit: RigFit, held_out: BoardError | None, against: RigError | None) -> list[Figure]:
    from vision_robot.geometry import triangulate

    middles = fit.rig_from_board.translation
    stand = fit.rig.cam_from_rig
    each = [camera.project(stand[i].apply(middles)) for i, camera in enumerate(fit.rig.cameras)]
    pixels = np.stack(each, axis=1)
    found = triangulate(fit.rig, pixels, max(fit.noise_px, 1e-6))
    known = np.isfinite(found.points[:, 0])
    plan = np.ix_([0, 2], [0, 2])
    covariance = np.array([one[plan] for one in found.covariance[known]])
    figures = [
        ellipses(
            1000 * found.points[known][:, [0, 2]],
            1e6 * covariance,
            ("x", "z"),
            caption="Seen from above: where a point of each board is known to be.",
        )
    ]
    for errors, name in ((held_out, "boards held out"), (against, "points against the truth")):
        if errors is None:
            continue
        sigma = 1000 * errors.foretold_m / np.sqrt(3)
        figures.append(
            scatter_rings(
                1000 * errors.errors[:, [0, 2]],
                float(sigma),
                "mm",
                ("dx", "dz"),
                alt=f"Errors of {name}",
                caption=f"Errors of {name}, with circles of what was foretold on average per axis, "
                f"{compact(float(sigma))} mm.",
            )
        )
    return figures
