"""What a caller hands over as numbers, before anything is done with it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puckpilot_env.options.inputs import in_short


def real_numbers(given: ArrayLike, whose: str) -> NDArray[Any]:
    """`given` as an array, of float32 where its floats are wider. ValueError, in one line that names `whose`, for
    words, complex numbers and objects: a cast would drop what it cannot keep, or fail without saying where."""
    try:
        array = np.asarray(given)
    except ValueError:  # rows of several lengths
        raise ValueError(f"{whose} is {in_short(given)}; expected real numbers, as many in each row") from None
    if array.dtype.kind not in "biuf":
        raise ValueError(f"{whose} has numbers of dtype {array.dtype}; expected real numbers")
    if array.dtype.kind == "f" and array.itemsize > 4:
        with np.errstate(over="ignore"):  # what is too large for a float32 is outside every space
            array = array.astype(np.float32)
    return array
