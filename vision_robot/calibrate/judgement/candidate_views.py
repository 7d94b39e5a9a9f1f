"""Where a person could hold a board: positions over the picture, sizes and tilts, in words."""

from dataclasses import dataclass

import numpy as np

from vision_robot.geometry import SE3, Camera, rotation_exp
from vision_robot.types import Array, Bool, Float, Int

__all__ = ["CandidateViews", "candidate_views"]

FILLS = (0.35, 0.6, 0.85)
"""Parts of the picture's width or height, whichever is fuller, that the print takes up."""

TILTS = (25.0, 45.0)
"""Degrees between the board's normal and the line of sight, beside facing it."""

AWAY = {"left": (0, 1), "right": (0, -1), "top": (-1, 0), "bottom": (1, 0)}
"""The edge that goes away from the camera, and the axis (x, y) the board turns about for it."""

PLACES = (
    *("in the upper left corner", "in the middle of the upper edge", "in the upper right corner"),
    *("in the middle of the left edge", "in the middle", "in the middle of the right edge"),
    *("in the lower left corner", "in the middle of the lower edge", "in the lower right corner"),
)
PARTS = {
    0.25: "a quarter",
    0.33: "a third",
    0.4: "two fifths",
    0.5: "half",
    0.6: "three fifths",
    0.67: "two thirds",
    0.75: "three quarters",
    0.85: "most",
    0.95: "nearly all",
}

MARGIN = 0.015
"""Of the picture's shorter side, left free around a whole board."""
OUTSIDE = 0.35
"""Of a coded board that sticks out of the picture."""
ATTEMPTS, ROUNDS = 6, 10


@dataclass(frozen=True)
class CandidateViews:
    """Board poses a person could hold, as the present camera would see them.

    `pixels` (k, n, 2) and `seen` (k, n) are those of the board's points; `cell` counts the
    3x3 places row by row; `away` is the edge turned away, -1 for a board that faces the
    camera, by `tilt` [rad] against the line of sight; `extent` (k, 2) is the part of the
    picture's width and height that the print takes up.
    """

    cam_from_board: SE3
    pixels: Float[Array, "k n 2"]
    seen: Bool[Array, "k n"]
    cell: Int[Array, "k"]
    away: Int[Array, "k"]
    tilt: Float[Array, "k"]
    extent: Float[Array, "k 2"]
    sticks_out: Bool[Array, "k"]

    def __len__(self) -> int:
        return len(self.cell)

    def __getitem__(self, some: slice | Array) -> "CandidateViews":
        """Some of the views."""
        fields = (self.pixels, self.seen, self.cell, self.away, self.tilt, self.extent, self.sticks_out)
        return CandidateViews(self.cam_from_board[some], *(field[some] for field in fields))

    def words(self, index: int) -> str:
        """How to hold the board, for a person who looks at the picture (not at a mirror image)."""
        place = PLACES[int(self.cell[index])] + " of the picture"
        if self.sticks_out[index]:
            place += ", a third of it sticking out"
        tilt = round(float(np.degrees(self.tilt[index])))
        turned = (
            f"its {list(AWAY)[int(self.away[index])]} edge {tilt}° away from the camera"
            if self.away[index] >= 0
            else "facing the camera squarely"
        )
        across = int(np.argmax(self.extent[index]))
        part = min(PARTS, key=lambda known: abs(known - self.extent[index, across]))
        size = f"{PARTS[part]} of the {('width', 'height')[across]}"
        return f"hold the board {place}, {turned}, so that it fills {size}"


def candidate_views(
    camera: Camera, board_points: Float[Array, "n 3"], *, whole: bool = True
) -> CandidateViews:
    """All combinations of 3x3 places, three sizes and nine tilts that fit into the picture.

    The print reaches one pitch past its outermost points and, where `whole`, lies inside the
    picture; otherwise (targets whose points carry their own identity) views are added in
    which a third of it sticks out. Tilts are against the line of sight, so they mean the
    same in the picture's corners.
    """
    turns, away, tilt = _turns()
    reaches = (0.0,) if whole else (0.0, OUTSIDE)
    grid = np.meshgrid(np.arange(9), np.arange(len(FILLS)), np.arange(len(turns)), reaches, indexing="ij")
    cell, size, turn, out = (axis.ravel() for axis in grid)
    keep = (out == 0) | (cell != 4)  # in the middle nothing sticks out
    cell, size, turn, out = cell[keep], size[keep], turn[keep], out[keep]
    aim = np.stack([cell % 3, cell // 3], axis=1) / 2
    outline = _outline(board_points)
    pose, extent, found = _placed(camera, outline, turns[turn], aim, np.array(FILLS)[size], out)
    pose, extent = pose[found], extent[found]
    pixels = camera.project(
        pose.apply(np.broadcast_to(board_points, (int(found.sum()), *board_points.shape)))
    )
    with np.errstate(invalid="ignore"):
        last = np.array([camera.width, camera.height]) - 0.5
        seen = np.all((pixels >= -0.5) & (pixels <= last), axis=-1)
    cell, turn, out = cell[found], turn[found], out[found]
    views = CandidateViews(pose, pixels, seen, cell, away[turn], tilt[turn], extent, out > 0)
    enough = seen.sum(axis=1) >= max(8, len(board_points) // 4)
    return views[enough & (seen.all(axis=1) | views.sticks_out)]


def _turns() -> tuple[Float[Array, "t 3 3"], Int[Array, "t"], Float[Array, "t"]]:
    """Rotations against the line of sight, the edge each turns away, and by how much."""
    axes, away, tilts = [np.zeros(3)], [-1], [0.0]
    for tilt in np.radians(TILTS):
        for i, axis in enumerate(AWAY.values()):
            axes.append(tilt * np.array([*axis, 0.0]))
            away.append(i)
            tilts.append(tilt)
    return rotation_exp(np.array(axes)), np.array(away), np.array(tilts)


def _outline(points: Float[Array, "n 3"]) -> Float[Array, "m 3"]:
    """Points along the border of the print, one pitch outside the outermost points."""
    first = points[np.argsort(np.linalg.norm(points - points[0], axis=1))[1]]
    pitch = np.linalg.norm(first - points[0])
    low, high = points[:, :2].min(axis=0) - pitch, points[:, :2].max(axis=0) + pitch
    s = np.linspace(0, 1, 9)[:-1]
    o = np.zeros_like(s)
    x, y = np.concatenate([s, o + 1, 1 - s, o]), np.concatenate([o, s, o + 1, 1 - s])
    return np.stack([low[0] + (high - low)[0] * x, low[1] + (high - low)[1] * y, np.zeros_like(x)], axis=1)


def _placed(
    camera: Camera, outline: Array, turn: Float[Array, "k 3 3"], aim: Array, fill: Array, out: Array
) -> tuple[SE3, Float[Array, "k 2"], Bool[Array, "k"]]:
    """Poses that give the print the wanted place and size in the picture, where they exist."""
    k = len(turn)
    rotation, translation = np.tile(np.eye(3), (k, 1, 1)), np.zeros((k, 3))
    extent, found = np.zeros((k, 2)), np.zeros(k, dtype=bool)
    aim, fill = aim.copy(), fill.copy()
    for _ in range(ATTEMPTS):
        left = np.flatnonzero(~found)
        if not len(left):
            break
        pose, extents, settled = _settled(camera, outline, turn[left], aim[left], fill[left], out[left])
        done = left[settled]
        rotation[done], translation[done] = pose.rotation[settled], pose.translation[settled]
        extent[done], found[done] = extents[settled], True
        # A lens that does not see the picture's corners wants the board nearer the centre.
        aim[left], fill[left] = 0.5 + 0.9 * (aim[left] - 0.5), 0.95 * fill[left]
    return SE3(rotation, translation), extent, found


def _settled(
    camera: Camera, outline: Array, turn: Array, aim: Array, fill: Array, out: Array
) -> tuple[SE3, Float[Array, "k 2"], Bool[Array, "k"]]:
    """Fixed-point iteration on the pixel of the print's middle and on its distance."""
    size = np.array([camera.width, camera.height], dtype=float)
    margin = MARGIN * size.min()
    low, high = margin - 0.5, size - 0.5 - margin
    middle = outline.mean(axis=0)
    k = len(turn)
    pixel = np.tile((size - 1) / 2, (k, 1))
    distance = np.full(k, 2 * np.ptp(outline, axis=0).max())
    out = out[:, None]
    first = last = wanted = pixel
    facing, translation = turn, np.zeros((k, 3))
    for _ in range(ROUNDS):
        ray = camera.unproject(pixel)
        facing = _towards(ray) @ turn
        translation = distance[:, None] * ray - facing @ middle
        pixels = camera.project(SE3(facing, translation).apply(np.broadcast_to(outline, (k, *outline.shape))))
        first, last = pixels.min(axis=1), pixels.max(axis=1)
        wide = last - first
        distance = distance * (wide / size).max(axis=1) / fill
        reach = out * wide
        wanted = low - reach + aim * np.maximum(high - low - wide + 2 * reach, 0)
        pixel = pixel + wanted - first
    # The middle of a print must have a ray; where the whole print must be seen, all of it lies inside.
    with np.errstate(invalid="ignore"):
        inside = np.all((first >= -0.5) & (last <= size - 0.5), axis=1) | (out[:, 0] > 0)
        near = np.all(np.abs(first - wanted) < 0.03 * size, axis=1)
    extents = np.minimum(last, size) - np.maximum(first, 0)
    settled = np.isfinite(translation).all(axis=1) & np.isfinite(first).all(axis=1) & inside & near
    return SE3(facing, translation), extents / size, settled


def _towards(ray: Float[Array, "k 3"]) -> Float[Array, "k 3 3"]:
    """The smallest rotation that turns the optical axis onto each ray."""
    axis = np.stack([-ray[:, 1], ray[:, 0], np.zeros(len(ray))], axis=1)
    sine = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sine, ray[:, 2])
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = np.where(sine > 1e-12, angle / sine, 1.0)
    return rotation_exp(scale[:, None] * axis)
