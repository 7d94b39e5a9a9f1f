"""The vocabulary of arrays.

Shapes are written in the type, as jaxtyping does: ``Float[Array, "n 2"]``. They are
documentation at run time and are checked, with beartype, in the tests only.
"""

import numpy as np
from jaxtyping import Bool, Float, Int, Integer, UInt8, UInt16

__all__ = ["Array", "Bool", "Float", "Image", "Int", "Integer", "UInt8", "UInt16"]

Array = np.ndarray

Image = UInt8[Array, "height width *channels"]
"""Grey (height, width) or blue-green-red (height, width, 3) image of 8-bit samples."""
