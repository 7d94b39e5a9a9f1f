"""Where a search starts: joint vectors spread evenly inside the limits, taken nearest to the goal first."""

from dataclasses import dataclass

import numpy as np

from vision_robot.arm.symbolic import length_scale
from vision_robot.arm.task import Task
from vision_robot.geometry import SerialChain
from vision_robot.types import Array, Float, Int

__all__ = ["Starts", "start_table", "windows"]

COUNT = 384
"""More starts are nearer to a goal, but cost more to look through: 64 and 2048 were slower."""


@dataclass(frozen=True)
class Starts:
    """Joint vectors and where they bring the tool."""

    q: Float[Array, "starts n"]
    pose: Float[Array, "starts 12"]
    weights: Float[Array, "12"]
    """What each number of a pose counts in the distance between two: metres, angles times a length."""

    def nearest(self, goals: Float[Array, "goals 12"], count: int) -> Int[Array, "goals count"]:
        """Indices of the starts whose tool is nearest to each goal, nearest first."""
        count = min(count, len(self.q))
        order = np.empty((len(goals), count), dtype=int)
        features = self.pose * self.weights
        squares = np.sum(features**2, axis=1)
        for first in range(0, len(goals), 2048):
            part = slice(first, first + 2048)
            distance = squares - 2 * (goals[part] * self.weights) @ features.T
            few = np.argpartition(distance, count - 1, axis=1)[:, :count]
            ranks = np.argsort(np.take_along_axis(distance, few, axis=1), axis=1, kind="stable")
            order[part] = np.take_along_axis(few, ranks, axis=1)
        return order


def start_table(chain: SerialChain, task: Task = Task.POSE, *, count: int = COUNT) -> Starts:
    """Evenly spread starts (Roberts 2018's additive sequence): the same for the same arm, always."""
    n, root = len(chain), 2.0
    for _ in range(60):
        root = (1 + root) ** (1 / (n + 1))
    share = (0.5 + np.outer(np.arange(1, count + 1), root ** -np.arange(1.0, n + 1))) % 1
    low, high = windows(chain).T
    q = low + (high - low) * share
    pose = chain.base_from_tool(q).as_matrix()[:, :3].reshape(-1, 12)
    return Starts(q, pose, pose_weights(chain, task))


def windows(chain: SerialChain) -> Float[Array, "n 2"]:
    """Limits, but no more than one whole turn about their middle: every pose within them is met there."""
    middle = chain.limits.mean(axis=1)
    half = np.diff(chain.limits, axis=1)[:, 0] / 2
    half = np.where(chain.slides, half, np.minimum(half, np.pi))
    return np.stack([middle - half, middle + half], axis=1)


def pose_weights(chain: SerialChain, task: Task) -> Float[Array, "12"]:
    """Weights under which the distance of two poses is that of the task: |dp|^2 + (scale angle)^2 or so."""
    weights = np.zeros((3, 4))
    weights[:, 3] = 1
    scale = length_scale(chain)
    if task is Task.POSE:
        weights[:, :3] = scale / np.sqrt(2)
    elif task is Task.AXIS:
        weights[:, 2] = scale
    elif task is Task.TILT:
        weights[2, :3] = scale
    return weights.ravel()
