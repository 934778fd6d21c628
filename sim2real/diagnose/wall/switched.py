"""A smooth law of bounces that a recording asks for as the simulator's own numbers, so that players meet it too."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from puckpilot_env.physics.effects import unlisted_bounce
from sim2real.diagnose.contact_laws import SHARES, UNIT
from sim2real.diagnose.piecewise import knots_and_values, tamed
from sim2real.diagnose.wall.data import Bounces
from sim2real.diagnose.wall.families import KNOTS, ONE_WAVE, RIPPLES, lengths_of_axes, lengths_of_walls

ROWS = unlisted_bounce.EFFECT.row_names

Numbers = Callable[[Bounces, np.ndarray], np.ndarray]


def _over(coordinate: Callable[[Bounces], np.ndarray]) -> Numbers:
    return lambda data, theta: knots_and_values(coordinate(data), UNIT * theta, KNOTS)


def _along_walls(data: Bounces, theta: np.ndarray) -> np.ndarray:
    return np.concatenate([lengths_of_walls(data), UNIT * theta])


def _by_place(data: Bounces, theta: np.ndarray) -> np.ndarray:
    return np.concatenate([lengths_of_axes(data), UNIT * theta * tamed(np.arange(RIPPLES))])


def _one_wave(length: float) -> Numbers:
    return lambda data, theta: np.concatenate([[length], UNIT * theta])


# family: kind of the simulator's change, and its numbers from the family's coefficients
SWITCHES: Mapping[str, tuple[int, Numbers]] = {
    "speed": (unlisted_bounce.BY_SPEED, _over(lambda d: d.closing)),
    "angle": (unlisted_bounce.BY_ANGLE, _over(lambda d: d.angle)),
    "place": (unlisted_bounce.BY_PLACE, _along_walls),
    "place alike on all walls": (unlisted_bounce.BY_PLACE_ALIKE, _by_place),
    "time": (unlisted_bounce.BY_TIME, _over(lambda d: d.t)),
    **{name: (unlisted_bounce.BY_WAVE, _one_wave(length)) for name, length in ONE_WAVE.items()},
}


def switched_on(law: str, data: Bounces, theta: np.ndarray) -> dict[str, float]:
    """Parameters of `unlisted_bounce` by name for the coefficients `theta` of a `law` such as "restitution by speed" on
    the bounces that it was fitted to.

    Empty for a law that the simulator has no table for: one that remembers a contact.
    """
    share, family = law.split(" by ", 1)
    if family not in SWITCHES:
        return {}
    kind, numbers = SWITCHES[family]
    found = [float(kind), float(SHARES[share]), *map(float, numbers(data, theta))]
    return dict(zip(ROWS, [*found, *[0.0] * (len(ROWS) - len(found))], strict=True))
