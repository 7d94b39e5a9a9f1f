"""`vr synth`: a dataset with exact truth from a recipe."""

from pathlib import Path
from typing import Annotated

import typer

from vision_robot_cli import completions
from vision_robot_cli.options import Json, Seed

__all__ = ["synth"]


def synth(
    recipe: Annotated[
        str | None,
        typer.Argument(
            help="Name of a recipe, or a *.toml file of your own.", autocompletion=completions.recipes
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder of the dataset; else named after the recipe.")
    ] = None,
    frames: Annotated[int | None, typer.Option(help="Frames, instead of the recipe's.")] = None,
    size: Annotated[str | None, typer.Option(help="Size such as 640x480, instead of the recipe's.")] = None,
    severity: Annotated[float, typer.Option(help="The recipe's dial, from 0 (easy) to 1 (hard).")] = 0.5,
    seed: Seed = 0,
    workers: Annotated[int, typer.Option(help="Processes that render; the bytes are the same.")] = 1,
    preview: Annotated[
        bool, typer.Option("--preview", help="Add preview.png, a contact sheet, and preview.webm.")
    ] = False,
    mp4: Annotated[bool, typer.Option("--mp4", help="Add video.mp4, to be played anywhere.")] = False,
    show_list: Annotated[bool, typer.Option("--list", help="Show the recipes, make nothing.")] = False,
    keys: Annotated[bool, typer.Option("--keys", help="Show every key that a recipe may have.")] = False,
    json: Json = False,
) -> None:
    """Render a dataset: frames, and the truth about every object in them to the last pixel.

    A run that was cut short goes on where it stopped.

    Example: vr synth single-rod -o rod --frames 120 --workers 2 --preview
    Example: vr synth --list
    """
    from vision_robot.errors import BadParameter
    from vision_robot_cli import synth_output
    from vision_robot_cli.output import emit_json, ticking
    from vision_robot_cli.quantities import whole_pair

    if show_list or keys:
        table = synth_output.recipes() if show_list else synth_output.keys()
        if json:
            emit_json("synth", table)
        else:
            print(synth_output.as_table(table))
        return
    if recipe is None:
        raise BadParameter("recipe", None, "given: 'vr synth --list' shows all")
    from vision_robot_synth.recipe import read_recipe

    chosen = read_recipe(recipe).with_video(frames=frames, size=whole_pair(size, "--size") if size else None)
    folder = out or Path(chosen.name)
    with ticking(f"rendering {chosen.name}") as tick:
        made = synth_output.make(chosen, folder, severity, seed, workers, tick)
    extra = synth_output.add_films(folder, preview=preview, mp4=mp4)
    if json:
        emit_json("synth", synth_output.as_json(made, workers, extra))
    else:
        print(synth_output.as_text(made, extra))
