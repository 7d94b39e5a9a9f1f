"""What pictures, videos and datasets can be wrong in."""

from collections.abc import Iterable

from .root import BadInput


class NoImages(BadInput):
    """A path names no image."""

    def __init__(self, paths: Iterable[object]):
        self.paths = [str(path) for path in paths]
        super().__init__(
            f"no image found in {', '.join(self.paths) or 'an empty list'}: "
            "give image files, a folder of images, a quoted pattern or a video"
        )


class UnreadableImage(BadInput):
    """A file exists but holds no image that can be decoded."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be read as an image ({why}): remove or replace it")


class MixedImageSizes(BadInput):
    """Images of one camera differ in size."""

    def __init__(self, first: object, size: tuple[int, int], other: object, other_size: tuple[int, int]):
        self.size, self.other_size = size, other_size
        super().__init__(
            f"{other} is {other_size[0]}x{other_size[1]} px but {first} is {size[0]}x{size[1]} px: "
            "one calibration needs images of one camera at one resolution"
        )


class BadVideo(BadInput):
    """A video cannot be read or written."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as a video: {why}")


class BadBag(BadInput):
    """A recording of ROS cannot be used."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as a ROS bag: {why}")


class BadFrame(BadInput):
    """A frame does not belong into the video it was given for."""

    def __init__(self, index: int, why: str):
        self.index, self.why = index, why
        super().__init__(f"frame {index} cannot be used: {why}")


class NoColour(BadInput):
    """The first frame does not show a colour to track."""

    def __init__(self, colour: str | None = None):
        self.colour = colour
        what = f"{colour} is not in the first frame" if colour else "no colour stands out in the first frame"
        super().__init__(f"{what}: pick a point or a region of the object (see `vr track pick`)")


class BadDataset(BadInput):
    """A folder is no dataset in a layout that this library reads, or an incomplete one."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as a dataset: {why}")


class BadRecipe(BadInput):
    """A recipe of a synthetic dataset cannot be used."""

    def __init__(self, recipe: object, why: str):
        self.recipe, self.why = str(recipe), why
        super().__init__(f"recipe {recipe}: {why}")
