"""The film and the stills of episodes that `vr pick` is asked for."""

from collections.abc import Sequence
from pathlib import Path

from vision_robot.errors import BadParameter
from vision_robot.pick.episode import Episode
from vision_robot.pick.episodes import Plan, run_episode
from vision_robot.pick.film import FPS, Film, Still, Stills, film_size
from vision_robot.pick.world import World
from vision_robot.video import CODECS, VideoWriter

__all__ = ["check_film", "stills_of", "write_film"]


def check_film(path: Path, fps: float) -> None:
    """Raise BadParameter for a film that cannot be, before hours of episodes."""
    if not 0.1 <= fps <= 200:
        raise BadParameter("--fps", fps, "from 0.1 to 200")
    if path.suffix.lower() not in CODECS:
        raise BadParameter("--video", str(path), f"a file named *{', *'.join(CODECS)}")


def write_film(world: World, plan: Plan, seed: int, path: Path, fps: float = FPS) -> Episode:
    """Play one episode again and film it."""
    with VideoWriter(path, film_size(world.view.camera), fps) as video:
        return run_episode(world, plan, seed, witness=Film(video.write, fps))


def stills_of(world: World, plan: Plan, seeds: Sequence[int]) -> dict[int, list[Still]]:
    """Pictures from each phase of the episodes of these seeds, played again."""
    found = {}
    for seed in seeds:
        witness = Stills()
        run_episode(world, plan, seed, witness=witness)
        found[seed] = witness.pictures
    return found
