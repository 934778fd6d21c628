"""All that a blow may lack, as columns of its residuals: the listed effects, and smooth laws of any shape."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.contact_laws import contact_columns
from sim2real.diagnose.engine.choose import Law
from sim2real.diagnose.mallet.data import Blows
from sim2real.diagnose.piecewise import spread_hats
from sim2real.diagnose.problem import Columns

if TYPE_CHECKING:
    from sim2real.diagnose.mallet.problem import MalletProblem

FRICTIONS = (0.05, 0.1, 0.2, 0.4)  # at which friction is looked for
KNOTS = 4  # of a smooth law


def mallet_columns(problem: MalletProblem, values: Mapping[str, float], free: Sequence[str]) -> Columns:
    """Every column of a mallet problem at one law."""
    smooth = [name for name, effect in EFFECTS.items() if effect.regime == "mallet" and name != "mallet_friction"]
    laws = [Law(name, EFFECTS[name].row_names) for name in smooth]
    friction = ("mallet_friction", "mallet_mu", FRICTIONS)
    return contact_columns(problem, values, free, laws, friction, FAMILIES, "mallet's ")


FAMILIES: dict[str, tuple[str, Callable[[Blows], np.ndarray]]] = {
    "speed": ("speed", lambda d: spread_hats(d.closing, KNOTS)),
    "angle": ("heading", lambda d: spread_hats(d.angle, KNOTS)),
    "place along the table": ("position", lambda d: spread_hats(d.place[:, 0], KNOTS)),
    "place across the table": ("position", lambda d: spread_hats(d.place[:, 1], KNOTS)),
    "time": ("time", lambda d: spread_hats(d.t, KNOTS)),
}
