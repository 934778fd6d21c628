"""Convert a nonparametric force to parameters of the simulator's `unlisted_force` or `unlisted_window`."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from puckpilot_env.physics.effects import unlisted_force
from puckpilot_env.physics.effects.unlisted_force import WAVES_X, WAVES_Y
from sim2real.diagnose.regimes.sliding.forces.basis_library import (
    cosine_sizes,
    ripple_sizes,
    time_knots,
)
from sim2real.diagnose.regimes.sliding.forces.motion import Motion
from sim2real.diagnose.regimes.sliding.forces.searched_forces import searched_force
from sim2real.diagnose.regimes.sliding.tuned import SLIDING
from sim2real.statistics.piecewise import spline_basis

ROWS = unlisted_force.EFFECT.row_names


def _scaled(motion: Motion, theta: np.ndarray) -> np.ndarray:
    return SLIDING.unit * theta


def _over_place(motion: Motion, theta: np.ndarray) -> np.ndarray:
    return SLIDING.unit * (theta.reshape(-1, WAVES_X * WAVES_Y) * cosine_sizes()).ravel()


def _ripples(axis: int) -> Callable[[Motion, np.ndarray], np.ndarray]:
    """A function for the numbers of each direction, padded with zeros to the simulator's count."""

    def numbers(motion: Motion, theta: np.ndarray) -> np.ndarray:
        each = SLIDING.unit * theta.reshape(-1, SLIDING.ripples[axis]) * ripple_sizes(axis)
        return np.pad(each, ((0, 0), (0, unlisted_force.RIPPLES - SLIDING.ripples[axis]))).ravel()

    return numbers


def _by_speed(motion: Motion, theta: np.ndarray) -> np.ndarray:
    """Knots and values, both padded with their last entry to the simulator's count."""
    knots = motion.speeds
    more = (0, unlisted_force.SPEED_KNOTS - len(knots))
    return np.concatenate(
        [np.pad(knots, more, "edge"), np.pad(SLIDING.unit * spline_basis(knots) @ theta, more, "edge")]
    )


def _by_time(motion: Motion, theta: np.ndarray) -> np.ndarray:
    """The first and last knot, and the values at all knots along each direction."""
    knots = time_knots(motion)
    values = SLIDING.unit * theta.reshape(-1, len(knots)) @ spline_basis(knots).T
    return np.concatenate([knots[[0, -1]], values.ravel()])


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
    "force by heading": (unlisted_force.BY_HEADING, _scaled),
    "push by time": (unlisted_force.PUSH_BY_TIME, _by_time),
    "brake by time": (unlisted_force.BRAKE_BY_TIME, _by_time),
}


def effect_parameters(family: str, motion: Motion, theta: np.ndarray) -> dict[str, float]:
    """The simulator's parameters by name, for the coefficients `theta` of a family fitted to `motion`.

    Empty for forces by the time since a contact, which the simulator does not support.
    """
    if searched := searched_force(family):
        return searched.effect(SLIDING.unit * theta)
    if family not in SWITCHES:
        return {}
    kind, numbers = SWITCHES[family]
    found = numbers(motion, theta)
    return dict(zip(ROWS, [float(kind), *map(float, found), *[0.0] * (len(ROWS) - 1 - len(found))], strict=True))
