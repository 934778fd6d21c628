"""The mallet on its gantry: third order in each axis, one small Runge-Kutta step at constant voltage.

A mallet's state is (x, x', x'', y, y', y''). With a belt or a gap between motor and mallet, the motors have a separate
state in the next six columns, and the first six are the mallet's.
"""

from __future__ import annotations

from math import pi, sin, tanh

from puckpilot_env.kernel import kernel

CREEP = 0.0005  # m/s, below which dry friction is less: so a motor under few volts creeps instead of standing
MOTOR = 6  # the first column of the motors' state, if that is separate from the mallet's


@kernel
def loss(law, hand, p, v):
    """The factor of the speed loss C7 v at position p and speed v: 1 in the baseline, and of a hand."""
    if hand:
        return 1.0
    factor = 1.0 + law.cubic_loss * v * v
    if law.rough != 0.0:
        factor += law.rough * sin(2.0 * pi * p / law.rough_length)
    return factor


@kernel
def advance_axis(law, hand, c5, c6, c7, force, mallet, first, h, out):
    """RK4 for C5 p''' + C6 p'' + C7 p' = force (Eq. 2-3 with their dots restored); state (p, p', p'') from `first`."""
    p, v, a = mallet[first], mallet[first + 1], mallet[first + 2]
    half = 0.5 * h
    j1 = (force - c6 * a - c7 * v * loss(law, hand, p, v)) / c5
    v2, a2 = v + half * a, a + half * j1
    j2 = (force - c6 * a2 - c7 * v2 * loss(law, hand, p + half * v, v2)) / c5
    v3, a3 = v + half * a2, a + half * j2
    j3 = (force - c6 * a3 - c7 * v3 * loss(law, hand, p + half * v2, v3)) / c5
    v4, a4 = v + h * a3, a + h * j3
    j4 = (force - c6 * a4 - c7 * v4 * loss(law, hand, p + h * v3, v4)) / c5
    out[first] = p + h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
    out[first + 1] = v + h * (a + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
    out[first + 2] = a + h * (j1 + 2.0 * j2 + 2.0 * j3 + j4) / 6.0


@kernel
def follow(law, mallet, first, h, out):
    """Advance one axis of the mallet by h seconds, in which its motor moves from its state in `mallet` to that in
    `out`.

    The belt: m'' = w^2 (p - m) + 2 zeta w (p' - m'), by RK4 along a parabola of the motor, without reaction on the
    motor. The gap: the motor drags the mallet at either end of it; the mallet rests in between.
    """
    m, u = mallet[first], mallet[first + 1]
    p, v, a = mallet[MOTOR + first], mallet[MOTOR + first + 1], mallet[MOTOR + first + 2]
    if law.belt_hz > 0.0:
        w = 2.0 * pi * law.belt_hz
        k, c = w * w, 2.0 * law.belt_zeta * w
        half = 0.5 * h
        pm, vm = p + half * (v + 0.25 * h * a), v + half * a
        pe, ve = out[MOTOR + first], out[MOTOR + first + 1]
        b1 = k * (p - m) + c * (v - u)
        u2 = u + half * b1
        b2 = k * (pm - m - half * u) + c * (vm - u2)
        u3 = u + half * b2
        b3 = k * (pm - m - half * u2) + c * (vm - u3)
        u4 = u + h * b3
        b4 = k * (pe - m - h * u3) + c * (ve - u4)
        out[first] = m + h * (u + 2.0 * u2 + 2.0 * u3 + u4) / 6.0
        out[first + 1] = u + h * (b1 + 2.0 * b2 + 2.0 * b3 + b4) / 6.0
        out[first + 2] = k * (pe - out[first]) + c * (ve - out[first + 1])
        return
    end, half_gap = out[MOTOR + first], 0.5 * law.backlash
    out[first] = max(end - half_gap, min(end + half_gap, m))
    dragged = out[first] != m
    out[first + 1] = out[MOTOR + first + 1] if dragged else 0.0
    out[first + 2] = out[MOTOR + first + 2] if dragged else 0.0


@kernel
def rubbing(law, v_x, v_y):
    """Volts that dry friction takes from both axes at the speeds (v_x, v_y) of the motors."""
    left = law.motor_friction_left * tanh((v_x - v_y) / CREEP)
    right = law.motor_friction_right * tanh((-v_x - v_y) / CREEP)
    return (
        left - right + law.axis_friction_x * tanh(v_x / CREEP),
        -left - right + law.axis_friction_y * tanh(v_y / CREEP),
    )


@kernel
def advance_mallets(law, mallets, volts, h, out):
    """Advance all mallets by h seconds; `mallets` (k, 6 or 12), `volts` (k, 2) at the motors."""
    half_radius = 0.5 * law.pulley_radius
    separate = mallets.shape[1] > MOTOR
    driven = MOTOR if separate else 0
    for k in range(mallets.shape[0]):
        hand = k > 0 and law.hand != 0.0
        lost_x, lost_y = (0.0, 0.0) if hand else rubbing(law, mallets[k, driven + 1], mallets[k, driven + 4])
        c5, c6, c7 = law.a1 - law.b1, law.a2 - law.b2, law.a3 - law.b3
        advance_axis(law, hand, c5, c6, c7, half_radius * (volts[k, 0] - lost_x), mallets[k], driven, h, out[k])
        c5, c6, c7 = law.a1 + law.b1, law.a2 + law.b2, law.a3 + law.b3
        advance_axis(law, hand, c5, c6, c7, half_radius * (volts[k, 1] - lost_y), mallets[k], driven + 3, h, out[k])
        if separate and hand:
            for column in range(MOTOR):
                out[k, column] = out[k, MOTOR + column]
        elif separate:
            follow(law, mallets[k], 0, h, out[k])
            follow(law, mallets[k], 3, h, out[k])
