"""The gantry's motion under the volts of both motors: third order, friction, and a belt that gives.

The third-order law `C5 p''' + C6 p'' + C7 p' = (R/2) V` of an axis (report E.1) factors into a first-order lag of the
volts, `u' = fast_rate (V - u)`, and `p'' = gain u - slow_rate p'`, with the poles of `axis_constants`. To this
second-order part friction is added, in volts: of each motor, against the travel of its belt, x - y of the left and
-x - y of the right one, and of each axis. The friction that acts is `friction * engaged`, where the share `engaged` in
-1...1 follows the travel: `d engaged / ds = (sign - engaged) / presliding` (Dahl, "A solid friction model", 1968). So
a short presliding length gives Coulomb friction that also holds at rest. A belt of x that gives puts a share of the
inertia behind a spring; the encoders sit on the motors' shafts, before it.
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.decay import decay

CONSTANTS = np.dtype(
    [
        ("slow_x", np.float64),  # 1/s, slow and fast rates of the axes
        ("slow_y", np.float64),
        ("fast_x", np.float64),
        ("fast_y", np.float64),
        ("gain_x", np.float64),  # m/s^2/V
        ("gain_y", np.float64),
        ("balance", np.float64),  # 1, left motor's gain is 1 + balance, the right one's 1 - balance
        ("braking", np.float64),  # 1, share of its volts that a motor loses while it brakes
        ("deadband", np.float64),  # V, volts that each motor loses
        ("sag", np.float64),  # 1/V, loss of volts with |V_left| + |V_right|
        ("friction_left", np.float64),  # V
        ("friction_right", np.float64),
        ("friction_x", np.float64),
        ("friction_y", np.float64),
        ("presliding", np.float64),  # m of travel over which friction builds up
        ("offset_x", np.float64),  # V
        ("offset_y", np.float64),
        ("beyond", np.float64),  # 1, share of x's inertia beyond the belt; 0: a rigid belt
        ("belt_rate", np.float64),  # rad/s, resonance of x with the shaft held
        ("belt_damping", np.float64),  # 1, part of critical
    ]
)  # fmt: skip
STATE = 12  # x, v_x, y, v_y, lagged volts of both, the belt's stretch and its rate, friction of L, R, x and y


@kernel
def at_motor(c, gain, volts, load, engaged):
    """What acts [V] of the `volts` of a motor whose friction is `engaged` against its motion, and whose supply has
    the `load` |V_left| + |V_right| [V]."""
    acting = gain * volts / (1.0 + c.sag * load)
    acting = math.copysign(max(abs(acting) - c.deadband, 0.0), acting)
    against = max(-math.copysign(engaged, volts * engaged), 0.0)  # 0 while it drives, 1 while it brakes
    return acting * (1.0 - c.braking * against)


@kernel
def axis_volts(c, left, right, s):
    """The volts (V_x, V_y) of the axes for those of the `left` and `right` motor in a state `s`."""
    load = abs(left) + abs(right)
    left = at_motor(c, 1.0 + c.balance, left, load, s[8])
    right = at_motor(c, 1.0 - c.balance, right, load, s[9])
    return left - right + c.offset_x, -left - right + c.offset_y


@kernel
def lagged(rate, volts, target, duration):
    """Mean over the `duration` [s] and end of volts that follow `target` [V] at a `rate` [1/s]."""
    fade = decay(rate * duration)
    mean = target + (volts - target) * (1.0 - fade) / (rate * duration)
    return mean, target + (volts - target) * fade


@kernel
def engage(c, engaged, travel):
    """The share of the friction that acts after some `travel` [m]."""
    sign = math.copysign(1.0, travel)
    return sign + (engaged - sign) * decay(abs(travel) / c.presliding)


@kernel
def accelerations(c, s, u_x, u_y, v_x, v_y, rate):
    """Accelerations [m/s^2] (x, y, stretch) of a state `s` under volts u [V] at the speeds v [m/s] of the axes and
    `rate` [m/s] of the belt's stretch."""
    left, right = c.friction_left * s[8], c.friction_right * s[9]
    a_x = c.gain_x * (u_x - left + right - c.friction_x * s[10]) - c.slow_x * v_x
    a_y = c.gain_y * (u_y + left + right - c.friction_y * s[11]) - c.slow_y * v_y
    if c.beyond <= 0.0:
        return a_x, a_y, 0.0
    pull = c.belt_rate * (c.belt_rate * s[6] + 2.0 * c.belt_damping * rate)  # of the part beyond the belt
    a_x = (a_x - c.beyond * pull) / (1.0 - c.beyond)
    return a_x, a_y, a_x - pull


@kernel
def advance(c, s, left, right, duration):
    """Advance a state `s` (STATE,) in place by a short `duration` [s] under constant volts of the motors.

    The lag is exact, the rest of second order (velocity Verlet).
    """
    target_x, target_y = axis_volts(c, left, right, s)
    u_x, s[4] = lagged(c.fast_x, s[4], target_x, duration)
    u_y, s[5] = lagged(c.fast_y, s[5], target_y, duration)
    half = 0.5 * duration
    a_x, a_y, a_s = accelerations(c, s, u_x, u_y, s[1], s[3], s[7])
    v_x, v_y, rate = s[1] + half * a_x, s[3] + half * a_y, s[7] + half * a_s
    d_x, d_y = v_x * duration, v_y * duration
    s[0], s[2], s[6] = s[0] + d_x, s[2] + d_y, s[6] + rate * duration
    slide(c, s, d_x, d_y)
    # at the end of the step the speeds are those of its middle, continued
    a_x, a_y, a_s = accelerations(c, s, u_x, u_y, v_x + half * a_x, v_y + half * a_y, rate + half * a_s)
    s[1], s[3], s[7] = v_x + half * a_x, v_y + half * a_y, rate + half * a_s


@kernel
def slide(c, s, d_x, d_y):
    """Let friction follow a travel (d_x, d_y) [m]."""
    s[8], s[9] = engage(c, s[8], d_x - d_y), engage(c, s[9], -d_x - d_y)
    s[10], s[11] = engage(c, s[10], d_x), engage(c, s[11], d_y)
