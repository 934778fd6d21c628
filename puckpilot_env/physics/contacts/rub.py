"""Dry friction along the line of a contact, with a puck that may spin."""

from __future__ import annotations

from puckpilot_env.kernel import kernel


@kernel
def rub(mu, inertia, radius, pressure, along, spin):
    """`(impulse [m/s], spin [rad/s])` of a contact: it stops the rim's slip, but is at most `mu` times the pressure.

    The puck touches with its point at -radius n, which slips by along - radius spin; an impulse j changes the slip by
    j (1 + 1/inertia). pressure: the normal impulse [m/s]; along: the tangential speed [m/s] before; inertia in units of
    mass radius^2. (Stronge, Impact Mechanics, chapter 3.)
    """
    most = mu * pressure
    impulse = -(along - radius * spin) / (1.0 + 1.0 / inertia)
    impulse = min(max(impulse, -most), most)
    return impulse, spin - impulse / (inertia * radius)
