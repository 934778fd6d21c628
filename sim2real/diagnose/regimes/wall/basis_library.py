"""The basis library of the walls: smooth changes of the share of a speed that each contact keeps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from puckpilot_env.physics.effects.unlisted_bounce import KNOTS, RIPPLES, WAVES
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.regimes.contact.candidates import basis_name_of
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.wall.data import KINDS, WallContacts, at_short_walls, place_along_wall
from sim2real.diagnose.regimes.wall.stretch import stretch_named
from sim2real.diagnose.regimes.wall.tuned import WALL
from sim2real.statistics.piecewise import after_contact_hats, cosine_basis, spread_hats

# Lengths [m] of a single wave along all walls; few contacts determine it, since it has few coefficients
WAVE_LENGTHS = 2.0 / np.arange(1.0, WALL.most_waves + 0.01, WALL.wave_step)


def wall_lengths(data: WallContacts) -> np.ndarray:
    """Largest place (4,) [m] of a contact along each of the walls KINDS; 1 for a wall without contacts."""
    s = place_along_wall(data)
    here = [data.kind == kind for kind in KINDS.values()]
    return np.array([max(float(s[some].max()), WALL.least_length) if some.any() else 1.0 for some in here])


def table_lengths(data: WallContacts) -> np.ndarray:
    """Largest place (2,) [m] of a contact along x and y."""
    return np.maximum(data.place.max(axis=0, initial=0.0), WALL.least_length)


def _at_walls(data: WallContacts) -> np.ndarray:
    return np.isin(data.kind, list(KINDS.values()))


def _by_place_on_each_wall(data: WallContacts) -> np.ndarray:
    """Cosines (n, 4 WAVES) of the place along each wall; 0 at a post."""
    columns, s = [], place_along_wall(data)
    for kind, length in zip(KINDS.values(), wall_lengths(data), strict=True):
        columns += [np.where(data.kind == kind, np.cos(np.pi * k * s / length), 0.0) for k in range(WAVES)]
    return np.stack(columns, axis=1)


def _by_place_on_all_walls(data: WallContacts) -> np.ndarray:
    """Cosines (n, RIPPLES) of the place along a wall: x at the long walls, y at the short ones; 0 at a post."""
    x, y = table_lengths(data)
    share = np.where(at_short_walls(data), data.place[:, 1] / y, data.place[:, 0] / x)
    return cosine_basis(share, RIPPLES) * _at_walls(data)[:, None]


def _by_single_wave(length: float) -> Callable[[WallContacts], np.ndarray]:
    """A function for the sine and cosine (n, 2) of a wave of `length` [m] along every wall; 0 at a post."""

    def wave(data: WallContacts) -> np.ndarray:
        phase = 2.0 * np.pi * place_along_wall(data) / length
        return np.stack([np.sin(phase), np.cos(phase)], axis=1) * _at_walls(data)[:, None]

    return wave


SINGLE_WAVES = {f"a wave of {length:.3f} m along the walls": length for length in WAVE_LENGTHS}

# By name: the quantity that a law depends on, and its basis functions (n, k)
BASIS_LIBRARY: dict[str, tuple[str, Callable[[WallContacts], np.ndarray]]] = {
    "speed": ("speed", lambda d: spread_hats(d.closing_speed, KNOTS)),
    "angle": ("heading", lambda d: spread_hats(d.incidence_angle, KNOTS)),
    "place": ("position", _by_place_on_each_wall),
    "place alike on all walls": ("position", _by_place_on_all_walls),
    "time": ("time", lambda d: spread_hats(d.t, KNOTS)),
    "time since a contact": ("history", lambda d: after_contact_hats(d.time_since_contact, KNOTS)),
    **{name: ("position", _by_single_wave(length)) for name, length in SINGLE_WAVES.items()},
}


def added_shares(data: WallContacts, law: Law) -> np.ndarray:
    """The change (n, k) of each contact's kept share of a speed by each coefficient of a smooth law."""
    name = basis_name_of(law)
    stretch = stretch_named(name)
    return CONTACT.coefficient_unit * (stretch.inside(data) if stretch else BASIS_LIBRARY[name][1](data))
