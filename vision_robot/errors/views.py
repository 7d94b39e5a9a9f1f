"""What views of a board or of a plane cannot tell."""

from collections.abc import Sequence

from .root import BadInput


class BoardNotFound(BadInput):
    """No image shows the board that was asked for."""

    def __init__(self, images: int, wanted: str, seen: str | None = None):
        self.images, self.wanted, self.seen = images, wanted, seen
        hint = f"; a board of {seen} was seen: try --size {seen}" if seen else "; check --board and --size"
        super().__init__(f"no {wanted} board found in {images} image(s){hint}")


class BadCornerFile(BadInput):
    """A text file of corners or board points cannot be used."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} cannot be used as corners: {why}")


class BadCameraFile(BadInput):
    """A camera file is truncated, unknown or inconsistent."""

    def __init__(self, path: object, why: str):
        self.path, self.why = str(path), why
        super().__init__(f"{path} is not a camera file this tool can use: {why}")


class TooFewViews(BadInput):
    """Fewer usable views than a calibration needs."""

    def __init__(self, usable: int, needed: int, given: int):
        self.usable, self.needed, self.given = usable, needed, given
        super().__init__(
            f"{usable} usable view(s) of {given} given: at least {needed} are needed; "
            "add images that show the whole board at different tilts"
        )


class DegenerateViews(BadInput):
    """The views leave parameters undetermined."""

    def __init__(self, undetermined: Sequence[str], why: str):
        self.undetermined, self.why = tuple(undetermined), why
        affine = {"fx", "fy", "cx", "cy", "skew"} & set(undetermined)
        mend = (
            "add views in which the board is tilted by 20-60 degrees in different directions"
            if affine
            else "take a simpler --model or --fix them, or add views that reach the picture's corners"
        )
        super().__init__(f"{', '.join(undetermined)} cannot be known from these views ({why}): {mend}")


class EdgeOnPlane(BadInput):
    """A plane is seen so nearly from the side that the picture does not tell where it is."""

    def __init__(self, image: str, elevation_deg: float, across_px: float):
        self.image, self.elevation_deg, self.across_px = image, elevation_deg, across_px
        super().__init__(
            f"{image} sees the plane edge-on (line of sight {elevation_deg:.1f} degrees above it, its points "
            f"within {across_px:.2g} px of a line): look down on it by 10 degrees or more"
        )


class AmbiguousPlane(BadInput):
    """Two tilts of a plane, mirrored about the line of sight, explain a picture equally well."""

    def __init__(self, image: str, apart_deg: float, gap_sigma: float):
        self.image, self.apart_deg, self.gap_sigma = image, apart_deg, gap_sigma
        super().__init__(
            f"{image} does not tell which of two tilts, {apart_deg:.1f} degrees apart, the plane has (they "
            f"differ by {gap_sigma:.1f} sigma): take the photo from nearer, or with a larger board or points "
            "farther apart"
        )


class UnlevelBoard(BadInput):
    """A board does not lie on the plane that the first view shows."""

    def __init__(self, image: str, height_mm: float, tilt_deg: float):
        self.image, self.height_mm, self.tilt_deg = image, height_mm, tilt_deg
        super().__init__(
            f"the board in {image} does not lie on the plane of the first photo ({height_mm:+.1f} mm off it, "
            f"tilted by {tilt_deg:.1f} degrees): lay it flat on the table, and keep the camera still"
        )


class OffPlane(BadInput):
    """A pixel sees no part of the work plane."""

    def __init__(self, name: str, pixel: tuple[float, float], why: str):
        self.name, self.pixel, self.why = name, pixel, why
        super().__init__(
            f"{name} at ({pixel[0]:.6g}, {pixel[1]:.6g}) px sees no part of the plane ({why}): leave it out"
        )


class UnlinkedCameras(BadInput):
    """Cameras of a rig that never saw the board at the same moment as the others."""

    def __init__(self, linked: Sequence[str], unlinked: Sequence[str]):
        self.linked, self.unlinked = tuple(linked), tuple(unlinked)
        super().__init__(
            f"{', '.join(unlinked)} never saw the board at the same moment as {', '.join(linked)}: take "
            "pictures with the board where two cameras see it, and give them one file name in both folders"
        )


class Unsynchronised(BadInput):
    """Two cameras of a rig do not show the board at the same places at the same moments."""

    def __init__(self, first: str, second: str, agreeing: int, moments: int, lag: int | None):
        self.first, self.second, self.agreeing, self.moments, self.lag = first, second, agreeing, moments, lag
        mend = "were the pictures taken at the same moment, by cameras fixed to each other, of one board?"
        if lag:
            mend = f"they agree when picture k of {first} goes with k{lag:+d} of {second}: rename the files"
        super().__init__(
            f"{first} and {second} put the board at the same place at {agreeing} of {moments} moments: {mend}"
        )
