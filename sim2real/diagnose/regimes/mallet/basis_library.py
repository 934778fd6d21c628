"""The basis library of the mallet: smooth changes of the share of a speed that each contact keeps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from puckpilot_env.physics.effects.unlisted_blow import KNOTS
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.regimes.contact.candidates import basis_name_of
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.mallet.data import MalletContacts
from sim2real.statistics.piecewise import spread_hats

# By name: the quantity that a law depends on, and the coordinate (n,) of each contact
COORDINATES: dict[str, tuple[str, Callable[[MalletContacts], np.ndarray]]] = {
    "speed": ("speed", lambda d: d.closing_speed),
    "angle": ("heading", lambda d: d.incidence_angle),
    "place along the table": ("position", lambda d: d.place[:, 0]),
    "place across the table": ("position", lambda d: d.place[:, 1]),
    "time": ("time", lambda d: d.t),
}


def _hats(coordinate: Callable[[MalletContacts], np.ndarray]) -> Callable[[MalletContacts], np.ndarray]:
    return lambda data: spread_hats(coordinate(data), KNOTS)


# By name: the quantity that a law depends on, and its basis functions (n, k)
BASIS_LIBRARY = {name: (depends, _hats(coordinate)) for name, (depends, coordinate) in COORDINATES.items()}


def added_shares(data: MalletContacts, law: Law) -> np.ndarray:
    """The change (n, k) of each contact's kept share of a speed by each coefficient of a smooth law."""
    return CONTACT.coefficient_unit * BASIS_LIBRARY[basis_name_of(law)][1](data)
