"""Small copies of the pictures a calibration was made from."""

from base64 import b64encode
from collections.abc import Mapping

import numpy as np

from vision_robot.report.calibration_findings import Findings
from vision_robot.report.page import Picture
from vision_robot.report.quantity import compact
from vision_robot.types import Image

__all__ = ["thumbnails"]

WIDTH_PX = 220
MOST = 60
ORANGE_BGR = (40, 110, 255)


def thumbnails(findings: Findings, images: Mapping[str, Image]) -> tuple[Picture, ...]:
    """Pictures of the views, their corners marked; those with the largest rms where there are many."""
    result = findings.result
    rms = result.view_rms_px
    given = [i for i, view in enumerate(result.corners) if view.image in images]
    shown = sorted(sorted(given, key=lambda i: -rms[i])[:MOST])
    return tuple(
        Picture(
            data_uri=_encoded(images[result.corners[i].image], result.corners[i].pixels),
            alt=f"View {i + 1} with its corners marked",
            caption=f"{i + 1}: {result.corners[i].image}, {compact(rms[i], 2)} px",
        )
        for i in shown
    )


def _encoded(image: Image, pixels: np.ndarray) -> str:
    import cv2

    scale = min(1.0, WIDTH_PX / image.shape[1])
    size = (max(1, round(image.shape[1] * scale)), max(1, round(image.shape[0] * scale)))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    if small.ndim == 2 or small.shape[2] == 1:
        small = cv2.cvtColor(small, cv2.COLOR_GRAY2BGR)
    # Centres of pixels sit at whole numbers in both pictures.
    for u, v in (pixels + 0.5) * scale - 0.5:
        cv2.circle(small, (round(8 * u), round(8 * v)), 10, ORANGE_BGR, -1, cv2.LINE_AA, 3)
    _, data = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, 78])
    return "data:image/jpeg;base64," + b64encode(data.tobytes()).decode()
