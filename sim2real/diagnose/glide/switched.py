"""A smooth force that a recording asks for as the simulator's own numbers, so that players meet it too."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from puckpilot_env.physics.effects import unlisted_force
from puckpilot_env.physics.effects.unlisted_force import KNOTS
from sim2real.diagnose.glide.families import UNIT, Motion, speed_knots, time_knots

ROWS = [row.name for row in unlisted_force.EFFECT.rows.values()]


def _as_they_are(motion: Motion, theta: np.ndarray) -> np.ndarray:
    return UNIT * theta


def _padded(values: np.ndarray) -> np.ndarray:
    """KNOTS values, the last one repeated."""
    return np.concatenate([values, np.repeat(values[-1], KNOTS - len(values))])


def _over(knots: Callable[[Motion], np.ndarray]) -> Callable[[Motion, np.ndarray], np.ndarray]:
    def numbers(motion: Motion, theta: np.ndarray) -> np.ndarray:
        at = knots(motion)
        return np.concatenate([_padded(at), *(_padded(UNIT * values) for values in theta.reshape(-1, len(at)))])

    return numbers


# family: kind of the simulator's force, and its numbers from the family's coefficients
SWITCHES: Mapping[str, tuple[int, Callable[[Motion, np.ndarray], np.ndarray]]] = {
    "push by position": (unlisted_force.PUSH_BY_PLACE, _as_they_are),
    "brake by position": (unlisted_force.BRAKE_BY_PLACE, _as_they_are),
    "brake by speed": (unlisted_force.BRAKE_BY_SPEED, _over(speed_knots)),
    "side force by speed": (unlisted_force.SIDE_BY_SPEED, _over(speed_knots)),
    "force by heading": (unlisted_force.BY_HEADING, _as_they_are),
    "push by time": (unlisted_force.PUSH_BY_TIME, _over(time_knots)),
    "brake by time": (unlisted_force.BRAKE_BY_TIME, _over(time_knots)),
}


def switched_on(family: str, motion: Motion, theta: np.ndarray) -> dict[str, float]:
    """Parameters of `unlisted_force` by name for the coefficients `theta` of a family on the `motion` it was fitted to.

    Empty for a family that the simulator has no table for: forces that remember a contact.
    """
    if family not in SWITCHES:
        return {}
    kind, numbers = SWITCHES[family]
    found = numbers(motion, theta)
    return dict(zip(ROWS, [float(kind), *map(float, found), *[0.0] * (len(ROWS) - 1 - len(found))], strict=True))
