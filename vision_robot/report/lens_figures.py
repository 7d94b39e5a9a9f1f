"""Drawings of the camera itself: its lens, how well it is known, how far from the truth it is."""

from typing import TYPE_CHECKING

import numpy as np

from vision_robot.calibrate.judgement.projection_uncertainty import picture_grid
from vision_robot.calibrate.result import CalibrationResult
from vision_robot.geometry import Camera
from vision_robot.report.calibration_findings import AgainstTruth, Findings
from vision_robot.report.figure import ACCENT, FAINT, INK, WARM, WIDTH_IN, draw
from vision_robot.report.page import Figure
from vision_robot.report.picture_axes import contour_map, picture_height_in
from vision_robot.report.quantity import compact
from vision_robot.types import Array, Float

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

__all__ = ["lens_figures", "truth_maps", "uncertainty_maps"]


def lens_figures(findings: Findings) -> tuple[Figure, Figure]:
    """The radial distortion, and how well the radius at which a ray is imaged is known."""
    result = findings.result
    camera = result.camera
    seen, edge = _angles(result)
    angle = np.linspace(0, edge, 161)
    truth = findings.truth.camera if findings.truth else None
    radius, sigma = _radius(camera, angle), _radius_sigma(result, angle)
    equidistant = camera.model == "fisheye"
    ideal = _focal(camera) * (angle if equidistant else np.tan(angle))
    true_radius = None if truth is None else _radius(truth, angle)

    def paint_shift(canvas: "Canvas") -> None:
        axes = _angle_axes(canvas, edge, seen)
        axes.plot(np.degrees(angle), radius - ideal, color=ACCENT, label="calibrated")
        if true_radius is not None:
            axes.plot(
                np.degrees(angle), true_radius - ideal, color=WARM, linestyle=(0, (4, 3)), label="truth"
            )
            axes.legend(loc="best", handlelength=2)
        axes.set_ylabel("radial shift [px]")

    def paint_band(canvas: "Canvas") -> None:
        axes = _angle_axes(canvas, edge, seen)
        axes.fill_between(
            np.degrees(angle), -2 * sigma, 2 * sigma, color="#c5d8ea", linewidth=0, label="± 2 σ"
        )
        if true_radius is not None:
            axes.plot(np.degrees(angle), true_radius - radius, color=WARM, label="truth less calibrated")
        axes.legend(loc="upper left", handlelength=2)
        axes.set_ylabel("radius [px]")

    law = "equidistant lens (f θ)" if equidistant else "pinhole (f tan θ)"
    at_seen = float(np.interp(seen, angle, sigma))
    about_truth = " with what the truth adds to it" if truth is not None else ""
    return (
        Figure(
            draw(paint_shift, height_in=0.62 * WIDTH_IN),
            alt="Radial shift of the picture against the angle from the optical axis",
            caption=f"Radial distortion: how much farther from the axis a ray is imaged than by a {law} of "
            "the same "
            f"focal length; at most {compact(float(np.abs(radius - ideal).max()))} px. Corners were seen up "
            "to "
            f"{np.degrees(seen):.1f}° (dotted line); beyond, as far as the picture reaches, the curve is "
            "extrapolated.",
        ),
        Figure(
            draw(paint_band, height_in=0.62 * WIDTH_IN),
            alt="Two-sigma band of the imaged radius against the angle from the optical axis",
            caption=f"How well the imaged radius is known{about_truth}: σ is {compact(at_seen, 2)} px where "
            "the "
            f"last corners were seen and {compact(float(sigma[-1]), 2)} px at the edge of the picture.",
        ),
    )


def uncertainty_maps(findings: Findings) -> tuple[Figure, ...]:
    """Projection uncertainty over the picture: at infinity, where the boards were, and there in mm."""
    camera = findings.result.camera
    height = picture_height_in(camera)
    distance = compact(1000 * findings.board_distance)

    def figure(size: Array, unit: str, of: str, how: str) -> Figure:
        middle = float(size[size.shape[0] // 2, size.shape[1] // 2])
        return Figure(
            draw(lambda canvas: contour_map(canvas, camera, findings.grid, size), height_in=height),
            alt=f"Contours of the uncertainty [{unit}] of {of} over the picture",
            caption=f"Uncertainty [{unit}] of {of}: one sigma in its worst direction, {how}. "
            f"{compact(middle, 2)} {unit} in the middle, {compact(float(np.nanmin(size)), 2)} to "
            f"{compact(float(np.nanmax(size)), 2)} {unit} over the picture.",
        )

    by_boards = "with the camera placed by the boards themselves"
    turned = "after the rotation that fits best over the whole picture is taken out"
    plane = f"positions on a plane that faces the camera at {distance} mm"
    return (
        figure(findings.sigma_at_infinity, "px", "the projection of points at infinity", turned),
        figure(findings.sigma_at_boards, "px", f"the projection of points at {distance} mm", by_boards),
        figure(findings.sigma_on_plane_mm, "mm", plane, by_boards),
    )


def truth_maps(findings: Findings, truth: AgainstTruth) -> tuple[Figure, Figure]:
    """Where the calibrated camera sees true rays, less where they are: plain and with a rotation removed."""
    camera = findings.result.camera
    height = picture_height_in(camera)

    def figure(difference: Array, error, how: str) -> Figure:
        size = np.linalg.norm(difference, axis=-1)
        return Figure(
            draw(lambda canvas: contour_map(canvas, camera, truth.grid, size), height_in=height),
            alt=f"Contours of the projection error against the truth over the picture, {how}",
            caption=f"Projection error [px] to the truth, {how}: {compact(error.rms_px)} px rms, "
            f"{compact(error.max_px)} px at most over the whole picture.",
        )

    turn = 1000 * float(np.linalg.norm(truth.rotation_fitted.rotation))
    return (
        figure(truth.map_same_ray, truth.same_ray, "the same ray through both cameras"),
        figure(
            truth.map_rotation_fitted,
            truth.rotation_fitted,
            f"after the best rotation ({compact(turn, 2)} mrad) is taken out",
        ),
    )


def _angle_axes(canvas: "Canvas", edge: float, seen: float) -> "Axes":
    axes = canvas.add_subplot()
    axes.axhline(0, color=FAINT, linewidth=0.6, zorder=0)
    axes.axvline(np.degrees(seen), color=INK, linewidth=0.7, linestyle=(0, (1, 2)))
    axes.set_xlim(0, np.degrees(edge))
    axes.set_xlabel("angle from the optical axis [°]")
    return axes


def _angles(result: CalibrationResult) -> tuple[float, float]:
    """Largest angles from the axis [rad] where a corner was seen and where the picture has a ray."""
    camera = result.camera

    def largest(pixels: Array) -> float:
        cosine = camera.unproject(pixels)[..., 2]
        return float(np.arccos(np.clip(np.nanmin(cosine), -1, 1)))

    pixels = np.concatenate([view.pixels for view in result.corners])
    outermost = np.argsort(np.linalg.norm(pixels - [camera.cx, camera.cy], axis=1))[-50:]
    return largest(pixels[outermost]), largest(picture_grid(camera))


def _focal(camera: Camera) -> float:
    return float(np.sqrt(camera.fx * camera.fy))


def _radius(camera: Camera, angle: Float[Array, "n"]) -> Float[Array, "n"]:
    """Radius [px] at which a ray at that angle is imaged, tangential terms left out; NaN past the fold."""
    s = camera.lens.field(np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)]))
    radius = _focal(camera) * camera.lens.radial(s, camera.distortion)[0]
    return np.where(s <= camera.lens.fold(camera.distortion), radius, np.nan)


def _radius_sigma(result: CalibrationResult, angle: Float[Array, "n"]) -> Float[Array, "n"]:
    """One sigma of that radius, from the covariance of focal lengths and coefficients."""
    camera, parameters = result.camera, result.camera.parameters
    J = np.zeros((len(angle), len(parameters)))
    for i in (0, 1, *range(5, len(parameters))):
        step = np.zeros(len(parameters))
        step[i] = 1e-6 * max(1.0, abs(parameters[i]))
        ahead, behind = (_radius(camera.with_parameters(parameters + sign * step), angle) for sign in (1, -1))
        J[:, i] = np.nan_to_num((ahead - behind) / (2 * step[i]))
    return np.sqrt(np.maximum(np.einsum("ni,ij,nj->n", J, result.covariance.intrinsics, J), 0))
