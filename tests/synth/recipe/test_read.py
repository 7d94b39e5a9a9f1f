"""Recipes: those that come along read, unknown words are refused, one extends another, the dial turns."""

from pathlib import Path

import pytest

from vision_robot.errors import BadParameter, BadRecipe
from vision_robot_synth.recipe import RECIPES, read_recipe, recipe_names
from vision_robot_synth.recipe.recipe import drawn

EXPECTED = {
    "calibration", "camera-shake", "clutter", "conveyor", "crowd", "gripper-approach", "illumination-drift",
    "many-objects", "motion-blur", "near-background", "noise", "occlusion", "shadow", "similar-colours",
    "single-rod", "speed", "stop-and-go",
}  # fmt: skip


def written(folder: Path, text: str, name: str = "mine") -> str:
    (folder / f"{name}.toml").write_text(text)
    return str(folder / f"{name}.toml")


def test_the_recipes_that_come_along_are_all_there_and_small():
    assert set(recipe_names()) == EXPECTED
    for name in recipe_names():
        recipe = read_recipe(name)
        assert recipe.video.description
        assert recipe.dial, name
        assert len((RECIPES / f"{name}.toml").read_text().splitlines()) <= 50


def test_defaults_hold_where_a_recipe_says_nothing(tmp_path):
    recipe = read_recipe(written(tmp_path, "frames = 7\n[things.ball]\nshape = 'disc'\n"))
    assert recipe.name == "mine"
    assert (recipe.video.frames, recipe.video.fps, recipe.video.size) == (7, 30, (640, 480))
    assert recipe.things["ball"].count == 1
    assert recipe.arm is None
    assert recipe.sensor(0).expose is not None


def test_a_recipe_extends_another_table_by_table(tmp_path):
    written(tmp_path, "frames = 9\n[things.a]\nshape='disc'\nlength_mm=20\n[things.b]\nshape='box'\n", "low")
    recipe = read_recipe(written(tmp_path, "extend = 'low.toml'\nfps = 10\n[things.a]\nlength_mm=30\n"))
    assert (recipe.video.frames, recipe.video.fps) == (9, 10)
    assert (recipe.things["a"].shape, recipe.things["a"].length_mm) == ("disc", 30)
    assert "b" in recipe.things
    own = read_recipe(written(tmp_path, "extend = 'single-rod'\n", "from-ours"))
    assert own.things == read_recipe("single-rod").things


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("frmaes = 3", r"frmaes is no key \(do you mean frames\?\); allowed are arm, belt, board, camera"),
        ("[camera]\nhight_mm = 3", r"camera.hight_mm is no key \(do you mean height_mm\?\)"),
        ("[things.rod]\ncolor = 'red'", r"things.rod.color is no key \(do you mean colour\?\)"),
        ("[sensor]\nnoise = 3", "sensor.noise is no key"),
        ("[things.rod]\ncolour = 'reddish'", "things.rod.colour is 'reddish': it must be red, orange"),
        ("[things.rod]\nmotion = 'fly'", "things.rod.motion is 'fly': it must be one of rest, free, roam"),
        ("frames = 0", "frames is 0: it must be a whole number from 1"),
        ("frames = [3, 9]", "frames is"),
        ("fps = true", "fps is True"),
        ("size = [640]", "size is .640.: it must be a list of 2 whole numbers from 16 to 16384"),
        ("[camera]\ntilt_deg = [40, 10]", "camera.tilt_deg"),
        ("[light]\nshadows = 1", "light.shadows is 1: it must be true or false"),
        ("things = 3", "things must be a table"),
        ("[things]\nrod = 3", "things.rod must be a table"),
        (
            "[severity]\n'things.rod.speed_mm_s' = [1, 2]",
            "severity turns 'things.rod.speed_mm_s', which is no",
        ),
        ("[severity]\n'sensor.blur_px' = 3", "severity of sensor.blur_px is 3: it must be .value at 0"),
        (
            "[severity]\n'sensor.blur_px' = [0, -3]",
            "severity of sensor.blur_px is -3: it must be a number from",
        ),
        ("extend = 'nothing'", "there is none of this name"),
        ("extend = 3", "extend is 3"),
        ("extend = 'mine.toml'", "it extends itself"),
        ("frames = ", "it is no TOML"),
    ],
)
def test_what_cannot_be_used_is_refused_by_name(tmp_path, text, why):
    with pytest.raises(BadRecipe, match=why) as caught:
        read_recipe(written(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_recipes_that_are_not_there():
    with pytest.raises(BadRecipe, match=r"do you mean single-rod\?"):
        read_recipe("singel-rod")
    with pytest.raises(BadRecipe, match="no such file"):
        read_recipe("none.toml")


def test_the_dial_turns_numbers_ranges_counts_and_colours(tmp_path):
    recipe = read_recipe(
        written(
            tmp_path,
            """
            [things.rod]
            [severity]
            "things.rod.count" = [1, 4]
            "things.rod.speed_mm_s" = [10, [20, 40]]
            "things.rod.colour" = ["#000000", [1.0, 0.5, 0.0]]
            "things.rod.shape" = ["rod", "box"]
            "light.drift" = [0, 0.5]
            "frames" = [10, 20]
            """,
        )
    )
    half = recipe.at(0.5)
    rod = half.things["rod"]
    assert rod.count == 2
    assert rod.speed_mm_s == (15, 25)
    assert rod.colour == ((0.5, 0.25, 0.0),)
    assert (recipe.at(0.4).things["rod"].shape, rod.shape) == ("rod", "box")
    assert half.light.drift == 0.25
    assert half.video.frames == 15
    assert recipe.at(1).things["rod"].count == 4
    for wrong in (-0.1, 1.1, float("nan")):
        with pytest.raises(BadParameter, match="severity"):
            recipe.at(wrong)


def test_ranges_are_drawn_by_seed_each_from_its_own_stream(tmp_path):
    text = "[things.rod]\ncount = 3\nlength_mm = [50, 90]\nspeed_mm_s = {}\n"
    fixed = read_recipe(written(tmp_path, text.format("40"))).things["rod"]
    ranged = read_recipe(written(tmp_path, text.format("[10, 80]"))).things["rod"]
    draws = [drawn(ranged, seed, "things.rod", i) for seed in range(3) for i in range(3)]
    assert len({one.length_mm for one in draws}) == 9
    assert all(50 <= one.length_mm <= 90 for one in draws)  # type: ignore[operator]
    assert drawn(ranged, 1, "things.rod", 2) == drawn(ranged, 1, "things.rod", 2)
    # Making one value a range leaves the others as they are drawn.
    assert drawn(fixed, 1, "things.rod", 2).length_mm == drawn(ranged, 1, "things.rod", 2).length_mm


def test_frames_and_size_from_outside():
    recipe = read_recipe("single-rod").with_video(frames=5, size=(64, 48))
    assert (recipe.video.frames, recipe.video.size) == (5, (64, 48))
    with pytest.raises(BadParameter, match="--frames"):
        recipe.with_video(frames=0)
    with pytest.raises(BadParameter, match="--size"):
        recipe.with_video(size=(4, 4))
