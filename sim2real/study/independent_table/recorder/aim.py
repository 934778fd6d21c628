"""Plans for a mallet: switching times that bring one axis to rest at a target, by root finding on the pole form.

Between switches an axis obeys C5 a' + C6 a + C7 v = F with a = v'. Its poles p solve C5 p^2 + C6 p + C7 = 0.
Integrating once, C5 a + C6 v + C7 (position - target) is a constant as soon as the voltage is off, so

    (R/2) V (2 t1 - t2) = C7 (target - position) - C6 v - C5 a         the axis settles on the target
    C5 a(t2) + C6 v(t2) = 0                                            and is there when the voltage goes off.

The first gives t2 from t1; the second is solved for t1 by bracketing. Appendix I asks for the same two conditions.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, sqrt

from scipy.optimize import brentq

from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.physics.volts import Plan

NOTHING = 1e-9  # s, shorter voltages are rounding errors and are omitted


def plan_to(law: Law, mallet: Sequence[float], target: tuple[float, float], volts: tuple[float, float]) -> Plan:
    """Plan (Vx, Vy, tx1, ty1, tx2, ty2) from a mallet state (6,) to rest at `target` with magnitudes `volts`."""
    half = 0.5 * law.pulley_radius
    x = (law.a1 - law.b1, law.a2 - law.b2, law.a3 - law.b3)
    y = (law.a1 + law.b1, law.a2 + law.b2, law.a3 + law.b3)
    volts_x, tx1, tx2 = axis_plan(x, half, tuple(mallet[0:3]), target[0], volts[0])
    volts_y, ty1, ty2 = axis_plan(y, half, tuple(mallet[3:6]), target[1], volts[1])
    return volts_x, volts_y, tx1, ty1, tx2, ty2


def axis_plan(
    c: tuple[float, float, float], half: float, state: tuple[float, ...], target: float, volts: float
) -> tuple[float, float, float]:
    """Signed volts, t1, t2 for one axis with coefficients c = (C5, C6, C7) and half = R/2."""
    position, v, a = state
    needed = c[2] * (target - position) - c[1] * v - c[0] * a
    if abs(needed) < NOTHING * half * volts:
        return volts, 0.0, 0.0
    for sign in (1.0, -1.0) if needed >= 0.0 else (-1.0, 1.0):
        force = half * volts * sign
        net = needed / force  # 2 t1 - t2
        earliest = max(net, 0.0)

        def unsettled(t1: float, force: float = force, net: float = net) -> float:
            speed, rate = coast(c, force, v, a, t1)
            speed, rate = coast(c, -force, speed, rate, t1 - net)  # t2 - t1
            return (c[0] * rate + c[1] * speed) / force

        start = unsettled(earliest)
        if start < -NOTHING:
            continue  # too fast already: this sign cannot stop there
        if start < NOTHING:
            return volts * sign, earliest, 2.0 * earliest - net
        latest = earliest + 0.01
        while unsettled(latest) > 0.0:
            latest += 2.0 * (latest - earliest)
        t1 = float(brentq(unsettled, earliest, latest, xtol=1e-12))  # type: ignore[arg-type] - scipy's stubs want a float64
        return volts * sign, t1, 2.0 * t1 - net
    return 0.0, 0.0, 0.0


def coast(c: tuple[float, float, float], force: float, v: float, a: float, t: float) -> tuple[float, float]:
    """Speed and acceleration after t seconds of constant force, from the two poles."""
    root = sqrt(c[1] * c[1] - 4.0 * c[0] * c[2])
    fast, slow = (-c[1] - root) / (2.0 * c[0]), (-c[1] + root) / (2.0 * c[0])
    terminal = force / c[2]
    of_fast = (a - slow * (v - terminal)) / (fast - slow)
    of_slow = v - terminal - of_fast
    decay_fast, decay_slow = of_fast * exp(fast * t), of_slow * exp(slow * t)
    return terminal + decay_fast + decay_slow, fast * decay_fast + slow * decay_slow
