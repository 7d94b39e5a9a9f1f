"""Reading recipes: TOML, what it extends, and every key checked by name."""

from collections.abc import Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from vision_robot.errors import BadRecipe
from vision_robot.reading import LARGEST_OPTIONS, read_text, toml_tree
from vision_robot_synth.recipe.parts import PARTS, Key, ThingPart, VideoPart, keys_of
from vision_robot_synth.recipe.recipe import Recipe
from vision_robot_synth.recipe.sensor_keys import SENSOR_KEYS

__all__ = ["RECIPES", "read_recipe", "recipe_names"]

RECIPES = Path(__file__).parents[1] / "recipes"
"""Where the recipes that come along are; each is named after its file."""

BASE = "base"
"""What the others extend; nothing to make by itself."""

OTHER_TABLES = ("things", "sensor", "severity")
DEEPEST = 8


def recipe_names() -> list[str]:
    """Names of the recipes that come along."""
    return sorted(path.stem for path in RECIPES.glob("*.toml") if path.stem != BASE)


def read_recipe(recipe: str | Path) -> Recipe:
    """A recipe by its name, or from a TOML file. Raises BadRecipe, naming key and allowed values."""
    path = _found(str(recipe), Path.cwd())
    tree, severity = _checked(path.stem, _merged(path, ()))
    return Recipe(path.stem, tree, severity)


def _found(recipe: str, beside: Path) -> Path:
    """The file of a recipe: a path with its suffix, or a name of those that come along."""
    if recipe.endswith(".toml"):
        path = beside / recipe
        if not path.is_file():
            raise BadRecipe(recipe, "there is no such file")
        return path
    if recipe not in (*recipe_names(), BASE):
        raise BadRecipe(
            repr(recipe),
            f"there is none of this name{_nearest(recipe, recipe_names())}; "
            "'vr synth --list' shows all, and a file of your own is named *.toml",
        )
    return RECIPES / f"{recipe}.toml"


def _merged(path: Path, below: tuple[Path, ...]) -> dict[str, Any]:
    """The tables of a file laid over those it extends."""
    if path in below or len(below) > DEEPEST:
        raise BadRecipe(path.stem, f"it extends itself, by way of {', '.join(p.stem for p in below)}")
    tree = toml_tree(read_text(path, BadRecipe, LARGEST_OPTIONS), path.name, BadRecipe)
    parent = tree.pop("extend", None)
    if parent is None:
        return tree
    if not isinstance(parent, str):
        raise BadRecipe(path.stem, f"extend is {parent!r}: it must be the name of a recipe or a *.toml file")
    return _over(_merged(_found(parent, path.parent), (*below, path)), tree)


def _over(low: dict[str, Any], high: Mapping[str, Any]) -> dict[str, Any]:
    """`high` laid over `low`, table by table."""
    both = dict(low)
    for name, value in high.items():
        old = both.get(name)
        both[name] = _over(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return both


def _checked(name: str, tree: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, tuple[Any, Any]]]:
    """The tree with values in their own types, and the dial; refuses what is unknown or not allowed."""
    video = keys_of(VideoPart)
    _known(name, "", tree, [*video, *PARTS, *OTHER_TABLES, "extend"])
    result: dict[str, Any] = _values(
        name, "", {k: v for k, v in tree.items() if k in video}, keys_of(VideoPart)
    )
    for table in (*PARTS, *OTHER_TABLES):
        if not isinstance(tree.get(table, {}), dict):
            raise BadRecipe(name, f"{table} must be a table, [{table}]")
    for table, part in PARTS.items():
        if table in tree:
            result[table] = _values(name, f"{table}.", tree[table], keys_of(part))
    result["sensor"] = _values(name, "sensor.", tree.get("sensor", {}), SENSOR_KEYS)
    result["things"] = {}
    for thing, values in tree.get("things", {}).items():
        if not isinstance(values, dict):
            raise BadRecipe(name, f"things.{thing} must be a table, [things.{thing}]")
        result["things"][thing] = _values(name, f"things.{thing}.", values, keys_of(ThingPart))
    return result, _dial(name, tree.get("severity", {}), result)


def _values(recipe: str, where: str, table: Mapping[str, Any], keys: Mapping[str, Key]) -> dict[str, Any]:
    _known(recipe, where, table, list(keys))
    return {key: _value(recipe, where + key, value, keys[key]) for key, value in table.items()}


def _value(recipe: str, where: str, value: Any, key: Key) -> Any:
    checked = key.kind.checked(value)
    if checked is None:
        raise BadRecipe(recipe, f"{where} is {value!r}: it must be {key.kind.allowed}")
    return checked


def _dial(recipe: str, table: Mapping[str, Any], tree: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """The ends of each dialled value, by its path such as things.rod.speed_mm_s."""
    dial = {}
    for path, ends in table.items():
        *tables, key = path.split(".")
        place = ".".join(tables)
        keys: Mapping[str, Key] = {}
        if place == "":
            keys = keys_of(VideoPart)
        elif place in PARTS:
            keys = keys_of(PARTS[place])
        elif place == "sensor":
            keys = SENSOR_KEYS
        elif len(tables) == 2 and tables[0] == "things" and tables[1] in tree["things"]:
            keys = keys_of(ThingPart)
        if key not in keys:
            raise BadRecipe(
                recipe,
                f'severity turns {path!r}, which is no key: write "things.rod.speed_mm_s" = [at 0, at 1]',
            )
        if not isinstance(ends, list) or len(ends) != 2:
            raise BadRecipe(recipe, f"severity of {path} is {ends!r}: it must be [value at 0, value at 1]")
        dial[path] = tuple(_value(recipe, f"severity of {path}", end, keys[key]) for end in ends)
    return dial


def _known(recipe: str, where: str, table: Mapping[str, Any], known: list[str]) -> None:
    for key in table:
        if key not in known:
            raise BadRecipe(
                recipe,
                f"{where}{key} is no key{_nearest(key, known)}; allowed are {', '.join(sorted(known))}",
            )


def _nearest(word: str, known: list[str]) -> str:
    close = get_close_matches(word, known, n=1) if len(word) < 100 else []
    return f" (do you mean {close[0]}?)" if close else ""
