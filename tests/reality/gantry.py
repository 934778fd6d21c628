"""The mallet on its gantry: third order in each axis, one small Runge-Kutta step at constant voltage."""

from __future__ import annotations

from numba import njit


@njit(error_model="numpy")
def advance_axis(c5, c6, c7, force, mallet, first, h, out):
    """RK4 for C5 p''' + C6 p'' + C7 p' = force (Eq. 2-3 with their dots restored); state (p, p', p'') from `first`."""
    p, v, a = mallet[first], mallet[first + 1], mallet[first + 2]
    half = 0.5 * h
    j1 = (force - c6 * a - c7 * v) / c5
    v2, a2 = v + half * a, a + half * j1
    j2 = (force - c6 * a2 - c7 * v2) / c5
    v3, a3 = v + half * a2, a + half * j2
    j3 = (force - c6 * a3 - c7 * v3) / c5
    v4, a4 = v + h * a3, a + h * j3
    j4 = (force - c6 * a4 - c7 * v4) / c5
    out[first] = p + h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
    out[first + 1] = v + h * (a + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
    out[first + 2] = a + h * (j1 + 2.0 * j2 + 2.0 * j3 + j4) / 6.0


@njit(error_model="numpy")
def advance_mallets(law, mallets, volts, h, out):
    """Every mallet through h seconds; `mallets` (k, 6) is (x, x', x'', y, y', y''), `volts` (k, 2) at the motors."""
    half_radius = 0.5 * law.pulley_radius
    for k in range(mallets.shape[0]):
        c5, c6, c7 = law.a1 - law.b1, law.a2 - law.b2, law.a3 - law.b3
        advance_axis(c5, c6, c7, half_radius * volts[k, 0], mallets[k], 0, h, out[k])
        c5, c6, c7 = law.a1 + law.b1, law.a2 + law.b2, law.a3 + law.b3
        advance_axis(c5, c6, c7, half_radius * volts[k, 1], mallets[k], 3, h, out[k])
