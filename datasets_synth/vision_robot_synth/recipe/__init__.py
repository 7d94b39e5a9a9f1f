"""Recipes: small TOML files that say what a dataset is to show."""

from vision_robot_synth.recipe.read import RECIPES, read_recipe, recipe_names
from vision_robot_synth.recipe.recipe import Recipe

__all__ = ["RECIPES", "Recipe", "read_recipe", "recipe_names"]
