"""The page of a work plane."""

from collections.abc import Mapping

import numpy as np

from vision_robot.calibrate.boards import Board
from vision_robot.evaluate.plane import plane_error
from vision_robot.extrinsics.plane import PlaneFit
from vision_robot.extrinsics.plane_held_out import HeldOut
from vision_robot.geometry import SE3, WorkPlane
from vision_robot.report.ellipse_figure import ellipses
from vision_robot.report.page import (
    Facts,
    Figure,
    Figures,
    Footer,
    Gallery,
    Page,
    Paragraph,
    Part,
    Picture,
    Remarks,
    Section,
    Table,
)
from vision_robot.report.photograph import photograph
from vision_robot.report.picture_axes import contour_map, picture_height_in
from vision_robot.report.pixel_figures import residual_arrows, scatter_rings
from vision_robot.report.quantity import compact, with_sigma
from vision_robot.report.space_figure import InSpace, space_figure
from vision_robot.report.versions import versions
from vision_robot.types import Array, Float, Image

__all__ = ["plane_page", "plane_piece"]

GRID = (7, 5)


def plane_page(
    fit: PlaneFit,
    *,
    held_out: HeldOut | None = None,
    board: Board | None = None,
    truth: WorkPlane | None = None,
    images: Mapping[str, Image] | None = None,  # noqa: ARG001 - as the other pages
    command: str = "",
    seed: int | None = None,
) -> Page:
    """Everything needed to judge a work plane, as one page."""
    sections = [
        Section("Result", (_facts(fit, held_out), Remarks(tuple(_remarks(fit, held_out, truth))))),
        Section("In space", (Figures((_space(fit),)),)),
        Section("Residuals", (Figures(tuple(_residuals(fit))),)),
        Section(
            "How well a point is measured",
            (Figures((_sigma_map(fit), _ellipses(fit, truth))), Paragraph(ABOUT)),
        ),
    ]
    if held_out is not None:
        sections.append(Section("Points held out", tuple(_held_out(held_out))))
    if fit.levels:
        sections.append(Section("Boards elsewhere", (_levels(fit),)))
    if fit.rejected:
        rows = tuple((one.image, str(one.corner), one.reason) for one in fit.rejected)
        sections.append(
            Section("Left out", (Table(("picture", "point", "reason"), rows, "Points left out."),))
        )
    target = f" of a {board.description}" if board else ""
    return Page(
        title="Work plane",
        summary=f"{{S}} before a fixed camera, from {sum(map(len, fit.views))} points{target} in "
        f"{len(fit.views)} "
        f"view(s). The residuals are {compact(fit.rms_px)} px rms per point.",
        sections=tuple(sections),
        footer=Footer(versions=versions(), seed=seed, command=command),
    )


def plane_piece(fit: PlaneFit, truth: WorkPlane, image: Image) -> tuple[Part, ...]:
    """What a longer story tells of a work plane: the board on the table, headline figures, errors."""
    picture = Picture(
        photograph(image), "A board lying on the table", "The board that tells where the table is."
    )
    return (
        Remarks(tuple(_remarks(fit, None, truth))),
        _facts(fit, None),
        Gallery((picture,), wide=True),
        Figures((_sigma_map(fit), _ellipses(fit, truth))),
    )


ABOUT = (
    "The sigma of a point holds the pixels' noise found in the residuals and the joint uncertainty "
    "of camera and "
    "pose, which cancel to a part where the board lay. The size of the print and how flat the table "
    "is are not in it."
)


def _facts(fit: PlaneFit, held_out: HeldOut | None) -> Facts:
    centre = 1000 * fit.plane.cam_from_station.inverse().translation
    sigma = np.sqrt(np.diag(fit.plane.pose_covariance))
    spread = 1000 * float(sigma[3:].max())
    items = [
        ("camera at", ", ".join(with_sigma(float(c), spread)[0] for c in centre) + " mm", "x, y, z in {S}"),
        ("σ of its place", f"{compact(spread, 2)} mm", "largest along an axis of the camera"),
        ("σ of its turn", f"{compact(float(np.degrees(sigma[:3]).max()), 2)}°", "largest about an axis"),
        ("line of sight", f"{compact(float(np.degrees(fit.elevation)))}°", "over the plane"),
        ("rms residual", f"{compact(fit.rms_px)} px", "per point, both axes together"),
        ("noise σ", f"{compact(fit.noise_px)} px", "per point and axis"),
    ]
    if held_out:
        items.append(
            (
                "points held out",
                f"{compact(1000 * held_out.rms_m)} mm",
                f"rms on the plane; foretold {compact(1000 * held_out.foretold_m)} mm",
            )
        )
    return Facts(tuple(items))


def _remarks(fit: PlaneFit, held_out: HeldOut | None, truth: WorkPlane | None) -> list[tuple[str, str]]:
    said = []
    if truth is not None:
        error = plane_error(fit.plane, truth)
        said.append(
            (
                "note",
                f"To the truth: the camera is {compact(1000 * error.camera_position_m)} mm off, "
                f"{error.points} points "
                f"of the table {compact(1000 * error.rms_m)} mm rms; foretold "
                f"{compact(1000 * error.foretold_m)} mm.",
            )
        )
    if fit.plane.known_camera.taken_as_exact:
        said.append(
            (
                "caution",
                "The camera file holds no covariance: the camera is taken as exact, and sigmas are "
                "too small.",
            )
        )
    if np.degrees(fit.elevation) < 20:
        said.append(
            ("caution", "The camera looks flat over the table: errors along its line of sight count most.")
        )
    if np.isfinite(fit.rival_gap):
        tone = "caution" if fit.rival_gap < 10 else "good"
        said.append((tone, f"The mirrored tilt explains the first view {fit.rival_gap:.0f} sigma less well."))
    if held_out and held_out.ratio > 1.5:
        said.append(
            (
                "caution",
                f"Points held out miss by {held_out.ratio:.1f} times what is foretold: is the print "
                f"flat and to "
                "scale, and the camera's lens model good enough?",
            )
        )
    elif held_out:
        said.append(("good", f"Points held out miss by {held_out.ratio:.2f} times what is foretold."))
    steep = [level for level in fit.levels if abs(level.height_m) > 4 * level.sigma_height_m]
    if steep:
        worst = max(steep, key=lambda level: abs(level.height_m))
        said.append(
            (
                "caution",
                f"In {worst.image} the board lies {1000 * worst.height_m:+.2f} mm off the first "
                f"one's plane: the table "
                "is not flat, or the board is not.",
            )
        )
    if len(fit.views) == 1:
        said.append(
            ("note", "More photos with the board elsewhere on the table would tell the plane better.")
        )
    return said


def _space(fit: PlaneFit) -> Figure:
    station_from_cam = fit.plane.cam_from_station.inverse()
    outlines = []
    for points in fit.points:
        low, high = points.min(axis=0), points.max(axis=0)
        corners = [
            points[np.argmin(points @ d)] for d in np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]])
        ]
        outlines.append(np.array(corners) if np.ptp(high - low) else points)
    scene = InSpace(
        cameras=[("{C}", fit.plane.camera, station_from_cam)],
        frames=[("{S}", SE3.identity())],
        outlines=outlines,
        points=np.concatenate(fit.points)[:: max(1, sum(map(len, fit.points)) // 400)],
    )
    return space_figure(
        scene,
        alt="The camera over the work plane",
        caption="The camera {C} and the station {S} with the points that were seen; x, y and z axes "
        "orange, green "
        "and blue.",
    )


def _residuals(fit: PlaneFit) -> list[Figure]:
    pixels = np.concatenate([view.pixels for view in fit.views])
    residuals = np.concatenate(fit.residuals)
    rings = scatter_rings(
        residuals * [1, -1],
        fit.noise_px,
        "px",
        ("du", "−dv"),
        alt="Scatter of residuals",
        caption="The same residuals about one origin, with circles of the noise.",
    )
    return [residual_arrows(fit.plane.camera, pixels, residuals), rings]


def _picture_grid(plane: WorkPlane, columns: int, rows: int) -> Float[Array, "rows columns 2"]:
    u = np.linspace(0, plane.camera.width - 1, columns)
    v = np.linspace(0, plane.camera.height - 1, rows)
    return np.stack(np.meshgrid(u, v), axis=-1)


def _sigma_map(fit: PlaneFit) -> Figure:
    from vision_robot.report.figure import draw

    camera = fit.plane.camera
    grid = _picture_grid(fit.plane, 48, 36)
    _, covariance = fit.plane.measure(grid.reshape(-1, 2), fit.noise_px)
    known = np.isfinite(covariance[:, 0, 0])
    worst = np.full(len(covariance), np.nan)
    worst[known] = 1000 * np.sqrt(np.linalg.eigvalsh(covariance[known])[:, 1])
    middle = float(np.nanmedian(worst))
    return Figure(
        draw(
            lambda canvas: contour_map(canvas, camera, grid, worst.reshape(grid.shape[:2])),
            height_in=picture_height_in(camera),
        ),
        alt="Sigma of a measured point over the picture",
        caption=f"Sigma [mm], in its worst direction, of a point measured where it is seen with the "
        f"noise found; "
        f"{compact(middle, 2)} mm is the median.",
    )


def _ellipses(fit: PlaneFit, truth: WorkPlane | None) -> Figure:
    pixels = _picture_grid(fit.plane, *GRID).reshape(-1, 2)
    errors = None
    if truth is not None:
        # The true camera's pixels of the same places: what the plane makes of them shows its error.
        true_positions, _ = truth.measure(pixels)
        found, _ = fit.plane.measure(pixels)
        errors = 1000 * (found - true_positions)
    positions, covariance = fit.plane.measure(pixels, fit.noise_px if truth is None else 0.0)
    known = np.isfinite(covariance[:, 0, 0])
    return ellipses(
        1000 * positions[known],
        1e6 * covariance[known],
        ("x", "y"),
        caption="The picture laid out on the work plane."
        + (" The noise of the measured pixel is left out here." if truth is not None else ""),
        errors_mm=None if errors is None else errors[known],
    )


def _held_out(held_out: HeldOut) -> list[Part]:
    sigma = 1000 * held_out.foretold_m / np.sqrt(2)
    return [
        Figures(
            (
                scatter_rings(
                    1000 * held_out.errors,
                    float(sigma),
                    "mm",
                    ("dx", "dy"),
                    alt="Errors of points held out",
                    caption="Errors on the plane of points left out of the fit, each fifth in turn, "
                    "with circles of "
                    f"what was foretold on average, {compact(float(sigma))} mm per axis.",
                ),
            )
        ),
        Paragraph(f"In units of its own foretold sigma a point misses by {held_out.ratio:.2f}; 1 is honest."),
    ]


def _levels(fit: PlaneFit) -> Table:
    rows = tuple(
        (
            level.image,
            f"{1000 * level.height_m:+.3f}".replace("-", "−"),
            f"{1000 * level.sigma_height_m:.3f}",
            f"{np.degrees(level.tilt):.3f}",
            f"{np.degrees(level.sigma_tilt):.3f}",
        )
        for level in fit.levels
    )
    return Table(
        ("picture", "height [mm]", "σ", "tilt [°]", "σ"),
        rows,
        "How boards found elsewhere lie to the plane of the first, from their own poses.",
        frozenset({1, 2, 3, 4}),
    )
