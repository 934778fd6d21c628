"""Convert a smooth mallet law to parameters of the simulator's effect `unlisted_blow`, so that it can be simulated."""

from __future__ import annotations

import numpy as np

from puckpilot_env.physics.effects import unlisted_blow
from sim2real.diagnose.regimes.contact.candidates import SHARE_NUMBERS
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.mallet.basis_library import COORDINATES, KNOTS
from sim2real.diagnose.regimes.mallet.data import MalletContacts
from sim2real.statistics.piecewise import knots_and_values

PREFIX = "mallet's "  # before the name of a law
PARAMETERS = unlisted_blow.EFFECT.row_names

# By the name of a basis: the `kind` of the effect
EFFECT_KINDS = {
    "speed": unlisted_blow.BY_SPEED,
    "angle": unlisted_blow.BY_ANGLE,
    "place along the table": unlisted_blow.BY_PLACE_ALONG,
    "place across the table": unlisted_blow.BY_PLACE_ACROSS,
    "time": unlisted_blow.BY_TIME,
}


def effect_parameters(law: str, data: MalletContacts, theta: np.ndarray) -> dict[str, float]:
    """Parameters of `unlisted_blow` by name, for a law such as "mallet's restitution by speed".

    data: the contacts to which the law was fitted; theta: its coefficients (k,).
    """
    share, basis = law.removeprefix(PREFIX).split(" by ", 1)
    numbers = knots_and_values(COORDINATES[basis][1](data), CONTACT.coefficient_unit * theta, KNOTS)
    found = [float(EFFECT_KINDS[basis]), float(SHARE_NUMBERS[share]), *map(float, numbers)]
    return dict(zip(PARAMETERS, found, strict=True))
