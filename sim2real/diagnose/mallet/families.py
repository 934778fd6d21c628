"""Families of smooth laws of blows: what may be added to the share of a speed past the mallet that each keeps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from puckpilot_env.physics.effects.unlisted_blow import KNOTS
from sim2real.diagnose.mallet.data import Blows
from sim2real.diagnose.piecewise import spread_hats

# by name: what it depends on, and of which number of each blow (n,) it is a function
COORDINATES: dict[str, tuple[str, Callable[[Blows], np.ndarray]]] = {
    "speed": ("speed", lambda d: d.closing),
    "angle": ("heading", lambda d: d.angle),
    "place along the table": ("position", lambda d: d.place[:, 0]),
    "place across the table": ("position", lambda d: d.place[:, 1]),
    "time": ("time", lambda d: d.t),
}


def _hats(of: Callable[[Blows], np.ndarray]) -> Callable[[Blows], np.ndarray]:
    return lambda data: spread_hats(of(data), KNOTS)


FAMILIES = {name: (depends, _hats(of)) for name, (depends, of) in COORDINATES.items()}
