"""Names and groups in a cell's model, and the measures that other files need."""

BACKGROUND, MOVING, FIXED, COLLIDERS = 0, 1, 2, 3
"""Groups of geoms: table, belt and floor; what can move; what stands; what collides and is not drawn."""
ITEM, ARM = "item/", "arm/"
"""Beginnings of names."""
TABLE, BELT, LABEL = "table", "belt", "label"
BACKGROUNDS = (TABLE, TABLE + "1", "belt_seen", "floor")

TABLE_THICKNESS_M = 0.03
LABEL_THICKNESS_M = 0.002
FLOOR_BELOW_M = 0.75
