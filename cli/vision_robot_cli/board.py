"""`vr board`: a calibration target to print."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli.options import BoardName, BoardOption, BoardSize, Json, Square

__all__ = ["board"]


def board(
    board: BoardName = "chessboard",
    size: BoardSize = "9x6",
    square: Square = "25mm",
    board_option: BoardOption = None,
    out: Annotated[Path, typer.Option("-o", "--out", help="File to write: *.pdf, *.svg or *.png.")] = Path(
        "board.pdf"
    ),
    page: Annotated[
        str | None,
        typer.Option(
            help="a4, a3, letter, ... or none: a page of the target's own size. "
            "Else the smallest of a4-a0 for PDF, none for SVG and PNG."
        ),
    ] = None,
    dpi: Annotated[float, typer.Option(help="Pixels per inch of a PNG.")] = 600,
    json: Json = False,
) -> None:
    """Draw a calibration target exactly to scale.

    Print at 100 % and hold a ruler against the bar below the pattern.

    Example: vr board --size 9x6 --square 25mm -o board.pdf
    """
    from vision_robot.calibrate.boards.paper import on_page
    from vision_robot.calibrate.boards.printing import print_drawing
    from vision_robot_cli.output import emit_json
    from vision_robot_cli.target import target as chosen

    target = chosen(board, size, square, board_option or ())
    drawing, sheet = target.drawing(), "none"
    if page != "none" and (page or out.suffix.lower() == ".pdf"):
        drawing, sheet = on_page(drawing, page)
    print_drawing(drawing, out, dpi=dpi)

    width, height = (1000 * side for side in (drawing.width, drawing.height))
    if json:
        result = {
            "board": board,
            "size": target.size,
            "description": target.description,
            "points": len(target.points),
            "page": sheet,
            "page_mm": [round(width, 6), round(height, 6)],
            "target_mm": [round(1000 * side, 6) for side in target.size_m],
            "out": str(out),
        }
        emit_json("board", result)
        return
    on = "" if sheet == "none" else f"{sheet} "
    print(f"{out}: {target.description}, on {on}{width:g} x {height:g} mm; print at 100 %")
