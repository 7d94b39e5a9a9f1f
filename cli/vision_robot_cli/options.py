"""Options that several commands share, so that they are spelt and explained the same everywhere."""

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["BoardOption", "Json", "Out", "Report", "Seed"]

BoardOption = Annotated[
    list[str] | None,
    typer.Option(
        help="What one target has besides: dictionary=DICT_4X4_50, marker_ratio=0.7 or legacy=1 of charuco, "
        "spacing=0.3 of aprilgrid, diameter_m=0.01 of circles. May be repeated."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Write one JSON object to stdout, nothing else.")]
Out = Annotated[Path | None, typer.Option("-o", "--out", help="Where the result is written.")]
Report = Annotated[Path | None, typer.Option("--report", help="Also write a self-contained HTML page.")]
Seed = Annotated[int, typer.Option("--seed", help="Seed of everything that is drawn by chance.")]
