"""Impulses: the change of velocity and spin by a contact. All per unit puck mass."""

from __future__ import annotations

from math import isnan, pi, sin

from puckpilot_env.kernel import kernel
from sim2real.study.independent_table.physics.puck import SINCE, SPIN, VX, VY, X, Y
from sim2real.study.independent_table.physics.table import MALLET, POST

RESTING = 1e-6  # m/s, speed of approach below which a contact is a lasting one


@kernel
def approach(which, puck, mallets, nx, ny):
    """Closing speed [m/s] of puck and obstacle along the normal; negative when they separate."""
    vx, vy = puck[VX], puck[VY]
    if which >= MALLET:
        vx -= mallets[which - MALLET, 1]
        vy -= mallets[which - MALLET, 4]
    return -(vx * nx + vy * ny)


@kernel
def bounce(law, t, which, puck, mallets, nx, ny):
    """Apply the impulse of a contact with obstacle `which` at time t in place."""
    puck[SINCE] = 0.0
    if which >= MALLET:
        off_mallet(law, t, which - MALLET, puck, mallets, nx, ny)
    else:
        off_wall(law, t, which, puck, nx, ny)


@kernel
def rub(law, mu, pressure, along, spin):
    """Coulomb impulse along the tangent: it stops the slip at the rim, at most mu times the normal impulse.

    The rim point at -r n moves with u = v_t - r w; an impulse j changes u by j (1 + 1/kappa) and w by -j/(kappa r).
    (Stronge, Impact Mechanics, ch. 3, for a disc of inertia kappa m r^2.) Returns j and the new spin.
    """
    slip = along - law.puck_radius * spin
    j = -slip / (1.0 + 1.0 / law.spin_inertia)
    limit = mu * pressure
    j = max(-limit, min(limit, j))
    return j, spin - j / (law.spin_inertia * law.puck_radius)


@kernel
def off_wall(law, t, which, puck, nx, ny):
    """Eq. (10): v_n -> -e v_n, v_t -> e v_t; effects are other constants and friction with spin."""
    closing = -(puck[VX] * nx + puck[VY] * ny)
    along = -puck[VX] * ny + puck[VY] * nx
    e = law.wall_restitution
    if which >= POST and not isnan(law.post_restitution):
        e = law.post_restitution
    if which == law.odd_wall:
        e += law.odd_wall_extra
    e += law.wall_warming * t
    if law.wall_wave != 0.0:
        e += law.wall_wave * sin(2.0 * pi * (puck[Y] if which < 2 else puck[X]) / law.wall_wave_length)
    if which == law.stretch_wall:
        s = puck[Y] if which < 2 else puck[X]
        e += law.stretch_extra if law.stretch_from < s < law.stretch_until else 0.0
    if law.restitution_power != 0.0 and closing > 0.0:
        e = min(1.0, e * closing**-law.restitution_power)
    e = max(0.0, e - law.restitution_slope * closing)
    if law.wall_spin > 0.0:
        j, puck[SPIN] = rub(law, law.wall_mu, (1.0 + e) * closing, along, puck[SPIN])
        along += j
    elif isnan(law.tangential_restitution):
        along *= e
    else:
        along *= law.tangential_restitution
    rebound = e * closing if closing > RESTING else 0.0
    puck[VX] = rebound * nx - along * ny
    puck[VY] = rebound * ny + along * nx


@kernel
def off_mallet(law, t, k, puck, mallets, nx, ny):
    """Reflect the velocity relative to the mallet: normal component with e, tangential kept; see `mallet_give`, and
    `hand` of whose second mallet nothing but the baseline's is true."""
    wx, wy = puck[VX] - mallets[k, 1], puck[VY] - mallets[k, 4]
    closing = -(wx * nx + wy * ny)
    hand = k > 0 and law.hand != 0.0
    give = 0.0 if hand else law.mallet_give
    e = law.mallet_restitution
    if not hand:
        e = e + law.mallet_warming * t - law.mallet_restitution_slope * closing
    e = max(0.0, e) if closing > RESTING else 0.0
    j_normal = (1.0 + e) * closing / (1.0 + give)
    j_along = 0.0
    if law.mallet_mu > 0.0 and not hand:
        j_along, puck[SPIN] = rub(law, law.mallet_mu, j_normal, -wx * ny + wy * nx, puck[SPIN])
    dvx, dvy = j_normal * nx - j_along * ny, j_normal * ny + j_along * nx
    puck[VX] += dvx
    puck[VY] += dvy
    mallets[k, 1] -= give * dvx
    mallets[k, 4] -= give * dvy
