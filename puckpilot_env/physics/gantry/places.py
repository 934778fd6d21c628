"""Where a mallet is at two times of its plan, as a camera that takes two frames asks."""

from __future__ import annotations

from puckpilot_env.kernel import inlined_kernel
from puckpilot_env.physics.gantry.decay import NEGLIGIBLE, decay
from puckpilot_env.physics.gantry.mallet import axis_place


@inlined_kernel
def _axis_at_both(axis, t, later):
    """Where an axis is [m] at `t` and `later` >= t [s]: quicker than twice `axis_at` where no part of the plan ends
    between them and the fast mode has reached its end."""
    if t < axis.t1:
        begin, end, volts = 0.0, axis.t1, axis.volts
        rest, slow = axis.rest, axis.slow
    else:
        begin, end, volts = axis.t1, axis.t2, -axis.volts
        rest, slow = axis.rest1, axis.slow1
    since, lag = t - begin, later - t
    if later >= min(end, axis.halt) or axis.fast_rate * since < NEGLIGIBLE:
        return axis_place(axis, t), axis_place(axis, later)
    speed = axis.rest_gain * volts
    slow_end = -axis.slow_gain * volts
    steady = rest + speed * since + slow_end + axis.fast_gain * volts
    slow = (slow - slow_end) * decay(axis.slow_rate * since)
    return steady + slow, steady + speed * lag + slow * decay(axis.slow_rate * lag)


@inlined_kernel
def places_at_both(mallet, t, later):
    """`place_at` at the times `t` and `later` of its plan: `(x, y, x later, y later)` [m]."""
    x, x_later = _axis_at_both(mallet.x, t, later)
    y, y_later = _axis_at_both(mallet.y, t, later)
    return x, y, x_later, y_later
