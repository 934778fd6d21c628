"""A view: what one position of the camera shows of markers and of measured points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class View:
    """`corners`: id of a marker -> its corners (4, 2) [pixels]; `pixels` (n, 2): where the puck was seen when it lay at
    `places` (n, 2) [m], measured by hand."""

    name: str
    corners: dict[int, np.ndarray]
    pixels: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    places: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
