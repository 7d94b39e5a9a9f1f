"""From a recipe to a cell: what lies where, how it moves, who looks at it."""
