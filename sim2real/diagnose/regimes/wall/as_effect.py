"""Convert a smooth wall law to parameters of the simulator's effect `unlisted_bounce`, so that it can be simulated."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from puckpilot_env.physics.effects import unlisted_bounce
from sim2real.diagnose.regimes.contact.candidates import SHARE_NUMBERS
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.wall.basis_library import KNOTS, RIPPLES, SINGLE_WAVES, table_lengths, wall_lengths
from sim2real.diagnose.regimes.wall.data import WallContacts
from sim2real.diagnose.regimes.wall.stretch import stretch_named
from sim2real.statistics.piecewise import expected_size, knots_and_values

PARAMETERS = unlisted_bounce.EFFECT.row_names

EffectNumbers = Callable[[WallContacts, np.ndarray], np.ndarray]  # from the coefficients (k,) as shares of a speed


def _over(coordinate: Callable[[WallContacts], np.ndarray]) -> EffectNumbers:
    return lambda data, added: knots_and_values(coordinate(data), added, KNOTS)


def _by_place_on_each_wall(data: WallContacts, added: np.ndarray) -> np.ndarray:
    return np.concatenate([wall_lengths(data), added])


def _by_place_on_all_walls(data: WallContacts, added: np.ndarray) -> np.ndarray:
    return np.concatenate([table_lengths(data), added * expected_size(np.arange(RIPPLES))])


def _by_single_wave(length: float) -> EffectNumbers:
    return lambda data, added: np.concatenate([[length], added])


# By the name of a basis: the `kind` of the effect, and its numbers
EFFECT_TABLES: Mapping[str, tuple[int, EffectNumbers]] = {
    "speed": (unlisted_bounce.BY_SPEED, _over(lambda d: d.closing_speed)),
    "angle": (unlisted_bounce.BY_ANGLE, _over(lambda d: d.incidence_angle)),
    "place": (unlisted_bounce.BY_PLACE, _by_place_on_each_wall),
    "place alike on all walls": (unlisted_bounce.BY_PLACE_ALIKE, _by_place_on_all_walls),
    "time": (unlisted_bounce.BY_TIME, _over(lambda d: d.t)),
    **{name: (unlisted_bounce.BY_WAVE, _by_single_wave(length)) for name, length in SINGLE_WAVES.items()},
}


def effect_parameters(law: str, data: WallContacts, theta: np.ndarray) -> dict[str, float]:
    """Parameters of `unlisted_bounce` by name, for a law such as "restitution by speed" with coefficients `theta` (k,).

    data: the contacts to which the law was fitted. Empty for a law that depends on the time since a contact, which the
    simulator does not support.
    """
    share, basis = law.split(" by ", 1)
    if stretch := stretch_named(basis):
        kind, numbers = unlisted_bounce.BY_STRETCH, stretch.numbers
    elif basis in EFFECT_TABLES:
        kind, numbers = EFFECT_TABLES[basis]
    else:
        return {}
    found = [
        float(kind), float(SHARE_NUMBERS[share]), *map(float, numbers(data, CONTACT.coefficient_unit * theta)),
    ]  # fmt: skip
    return dict(zip(PARAMETERS, [*found, *[0.0] * (len(PARAMETERS) - len(found))], strict=True))
