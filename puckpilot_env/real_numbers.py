"""What a caller hands over as numbers, before anything is done with it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def real_numbers(given: ArrayLike, whose: str) -> NDArray[Any]:
    """`given` as an array. ValueError, in one line that names `whose`, for words, complex numbers and objects: a cast
    would drop what it cannot keep, or fail without saying where."""
    array = np.asarray(given)
    if array.dtype.kind not in "biuf":
        raise ValueError(f"{whose} has numbers of dtype {array.dtype}; expected real numbers")
    return array
