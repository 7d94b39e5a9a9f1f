"""A covariance in our JSON: ``{"parameters": [names], "matrix": [[...]]}``."""

from collections.abc import Sequence

import numpy as np

from vision_robot.errors import BadParameter
from vision_robot.formats.tree import Tree
from vision_robot.geometry.known_camera import checked_covariance
from vision_robot.types import Array, Float

__all__ = ["covariance_object", "read_covariance"]


def covariance_object(names: Sequence[str], matrix: Float[Array, "n n"]) -> dict[str, object]:
    """The object to write; all digits are kept."""
    return {"parameters": list(names), "matrix": matrix.tolist()}


def read_covariance(tree: Tree, names: Sequence[str]) -> Float[Array, "n n"]:
    """The matrix in the order of `names`, whatever the order and the other rows of the file.

    Raises BadCameraFile where a name is missing or the numbers are no covariance.
    """
    listed = tree.get("parameters")
    if not (isinstance(listed.value, list) and all(isinstance(name, str) for name in listed.value)):
        raise listed.bad("a list of names expected")
    missing = [name for name in names if name not in listed.value]
    if missing:
        raise listed.bad(f"{', '.join(missing)} missing")
    n = len(listed.value)
    matrix = tree.get("matrix")
    numbers = np.array(matrix.numbers(n * n)).reshape(n, n)
    order = [listed.value.index(name) for name in names]
    try:
        return checked_covariance(numbers[np.ix_(order, order)], len(names), "file")
    except BadParameter as error:
        raise matrix.bad(str(error)) from error
