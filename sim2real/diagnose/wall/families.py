"""Families of smooth laws of bounces: what may be added to the share of a speed that each keeps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from puckpilot_env.physics.effects.unlisted_bounce import KNOTS, RIPPLES, WAVES
from sim2real.diagnose.contact_laws import UNIT, shape_of
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.piecewise import memory_hats, ripples, spread_hats
from sim2real.diagnose.wall.data import KINDS, Bounces

LENGTHS = 2.0 / np.arange(1.0, 7.01, 0.125)  # m, of a single wave along all walls; it needs few bounces to be told
SHORTEST = 1e-3  # m, of the way along a wall on which bounces are


def lengths_of_walls(data: Bounces) -> np.ndarray:
    """How far along (4,) [m] each of the walls KINDS bounces are; 1 where there are none."""
    s = _along(data)
    here = [data.kind == kind for kind in KINDS.values()]
    return np.array([max(float(s[some].max()), SHORTEST) if some.any() else 1.0 for some in here])


def lengths_of_axes(data: Bounces) -> np.ndarray:
    """How far along x and y (2,) [m] bounces are."""
    return np.maximum(data.place.max(axis=0, initial=0.0), SHORTEST)


def _ends(data: Bounces) -> np.ndarray:
    return (data.kind == KINDS["x0"]) | (data.kind == KINDS["x1"])


def _along(data: Bounces) -> np.ndarray:
    """Places (n,) [m] along the walls: y at the short ones, x elsewhere."""
    return np.where(_ends(data), data.place[:, 1], data.place[:, 0])


def _along_walls(data: Bounces) -> np.ndarray:
    """Cosines of the place along each wall (n, 4 WAVES), with which a restitution may vary."""
    columns, s = [], _along(data)
    for kind, length in zip(KINDS.values(), lengths_of_walls(data), strict=True):
        columns += [np.where(data.kind == kind, np.cos(np.pi * k * s / length), 0.0) for k in range(WAVES)]
    return np.stack(columns, axis=1)


def _by_place(data: Bounces) -> np.ndarray:
    """Ripples (n, RIPPLES) of how far along its wall a bounce is: along x at the long walls, along y at the short ones;
    nothing at a post."""
    x, y = lengths_of_axes(data)
    share = np.where(_ends(data), data.place[:, 1] / y, data.place[:, 0] / x)
    return ripples(share, RIPPLES) * np.isin(data.kind, list(KINDS.values()))[:, None]


def _one_wave(length: float) -> Callable[[Bounces], np.ndarray]:
    """A wave (n, 2) of this length [m] along every wall, by its sine and cosine; nothing at a post."""

    def wave(data: Bounces) -> np.ndarray:
        turns = 2.0 * np.pi * _along(data) / length
        return np.stack([np.sin(turns), np.cos(turns)], axis=1) * np.isin(data.kind, list(KINDS.values()))[:, None]

    return wave


ONE_WAVE = {f"a wave of {length:.3f} m along the walls": length for length in LENGTHS}
FAMILIES: dict[str, tuple[str, Callable[[Bounces], np.ndarray]]] = {
    "speed": ("speed", lambda d: spread_hats(d.closing, KNOTS)),
    "angle": ("heading", lambda d: spread_hats(d.angle, KNOTS)),
    "place": ("position", _along_walls),
    "place alike on all walls": ("position", _by_place),
    "time": ("time", lambda d: spread_hats(d.t, KNOTS)),
    "time since a contact": ("history", lambda d: memory_hats(d.since, KNOTS)),
    **{name: ("position", _one_wave(length)) for name, length in ONE_WAVE.items()},
}


def shares(data: Bounces, law: Law) -> np.ndarray:
    """What the coefficients of a smooth law add (n, k) to the share of a speed that each bounce keeps."""
    return UNIT * FAMILIES[shape_of(law)][1](data)
