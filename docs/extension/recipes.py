"""The table of recipes of datasets, from the recipes themselves."""

from vision_robot_synth.recipe import read_recipe, recipe_names

__all__ = ["recipes_table"]


def recipes_table() -> str:
    """Markdown to be included by the page of file formats."""
    rows = ["| recipe | makes | the dial of severity turns |", "|---|---|---|"]
    for name in recipe_names():
        recipe = read_recipe(name)
        turns = ", ".join(f"`{key}`" for key in recipe.dial)
        rows.append(f"| `{name}` | {recipe.video.description} | {turns} |")
    return "\n".join([*rows, ""])
