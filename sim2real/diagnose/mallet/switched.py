"""A smooth law of blows that a recording asks for as the simulator's own numbers, so that players meet it too."""

from __future__ import annotations

import numpy as np

from puckpilot_env.physics.effects import unlisted_blow
from sim2real.diagnose.contact_laws import SHARES, UNIT
from sim2real.diagnose.mallet.data import Blows
from sim2real.diagnose.mallet.families import COORDINATES, KNOTS
from sim2real.diagnose.piecewise import knots_and_values

OWNER = "mallet's "  # before the name of a law
ROWS = unlisted_blow.EFFECT.row_names
KINDS = {
    "speed": unlisted_blow.BY_SPEED,
    "angle": unlisted_blow.BY_ANGLE,
    "place along the table": unlisted_blow.BY_PLACE_ALONG,
    "place across the table": unlisted_blow.BY_PLACE_ACROSS,
    "time": unlisted_blow.BY_TIME,
}


def switched_on(law: str, data: Blows, theta: np.ndarray) -> dict[str, float]:
    """Parameters of `unlisted_blow` by name for the coefficients `theta` of a `law` such as "mallet's restitution by
    speed" on the blows that it was fitted to."""
    share, family = law.removeprefix(OWNER).split(" by ", 1)
    numbers = knots_and_values(COORDINATES[family][1](data), UNIT * theta, KNOTS)
    return dict(zip(ROWS, [float(KINDS[family]), float(SHARES[share]), *map(float, numbers)], strict=True))
