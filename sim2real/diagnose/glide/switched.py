"""A smooth force that a recording asks for as the simulator's own numbers, so that players meet it too."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from puckpilot_env.physics.effects import unlisted_force
from puckpilot_env.physics.effects.unlisted_force import WAVES_X, WAVES_Y
from sim2real.diagnose.glide.families import RIPPLES, UNIT, WAVES, Motion, along_axis, over_place, time_knots
from sim2real.diagnose.piecewise import stiff

ROWS = unlisted_force.EFFECT.row_names


def _as_they_are(motion: Motion, theta: np.ndarray) -> np.ndarray:
    return UNIT * theta


def _over_place(motion: Motion, theta: np.ndarray) -> np.ndarray:
    return UNIT * (theta.reshape(-1, WAVES_X * WAVES_Y) * over_place()).ravel()


def _ripples(axis: int) -> Callable[[Motion, np.ndarray], np.ndarray]:
    """For each direction as many numbers as the simulator has, the last ones 0."""

    def numbers(motion: Motion, theta: np.ndarray) -> np.ndarray:
        each = UNIT * theta.reshape(-1, RIPPLES[axis]) * along_axis(axis)
        return np.pad(each, ((0, 0), (0, unlisted_force.RIPPLES - RIPPLES[axis]))).ravel()

    return numbers


def _by_speed(motion: Motion, theta: np.ndarray) -> np.ndarray:
    """Knots and values, the last ones repeated."""
    knots = motion.speeds
    more = (0, unlisted_force.SPEED_KNOTS - len(knots))
    return np.concatenate([np.pad(knots, more, "edge"), np.pad(UNIT * stiff(knots) @ theta, more, "edge")])


def _by_time(motion: Motion, theta: np.ndarray) -> np.ndarray:
    knots = time_knots(motion)
    values = UNIT * theta.reshape(-1, len(knots)) @ stiff(knots).T  # along each direction
    return np.concatenate([knots[[0, -1]], values.ravel()])


def _wave(period: float, motion: Motion, theta: np.ndarray) -> np.ndarray:
    return np.array([period, *UNIT * theta])


# family: kind of the simulator's force, and its numbers from the family's coefficients
SWITCHES: Mapping[str, tuple[int, Callable[[Motion, np.ndarray], np.ndarray]]] = {
    "push by position": (unlisted_force.PUSH_BY_PLACE, _over_place),
    "brake by position": (unlisted_force.BRAKE_BY_PLACE, _over_place),
    "push by place along the table": (unlisted_force.PUSH_BY_X, _ripples(0)),
    "push by place across the table": (unlisted_force.PUSH_BY_Y, _ripples(1)),
    "brake by place along the table": (unlisted_force.BRAKE_BY_X, _ripples(0)),
    "brake by place across the table": (unlisted_force.BRAKE_BY_Y, _ripples(1)),
    "brake by speed": (unlisted_force.BRAKE_BY_SPEED, _by_speed),
    "side force by speed": (unlisted_force.SIDE_BY_SPEED, _by_speed),
    "force by heading": (unlisted_force.BY_HEADING, _as_they_are),
    "push by time": (unlisted_force.PUSH_BY_TIME, _by_time),
    "brake by time": (unlisted_force.BRAKE_BY_TIME, _by_time),
    **{name: (unlisted_force.BRAKE_BY_WAVE, partial(_wave, period)) for name, period in WAVES.items()},
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
