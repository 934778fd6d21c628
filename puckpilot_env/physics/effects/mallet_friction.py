"""The mallet's rim rubs: a Coulomb impulse along it, which also makes the puck spin."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts.rub import rub

_SOURCE = "a documented choice"

EFFECT = Effect(
    regime="mallet",
    law="impulse along = -slip / (1 + 1/kappa), at most mu times the normal one, slip = v_t - r spin",
    rows={
        "mu": Parameter("mallet_mu", "1", 0.0, 0.0, 1.0, "friction between puck and mallet", _SOURCE),
    },
    depends_on=("heading", "history"),
    excited_by="oblique strikes",
    source="Stronge, Impact Mechanics, chapter 3",
)


@kernel
def mallet_tangent(p, impulse, along, spin, after):
    """Slip or grip."""
    if p.mallet_mu <= 0.0:
        return after, spin
    rubbed, turned = rub(p.mallet_mu, p.spin_inertia, p.puck_radius, impulse, along, spin)
    return after + rubbed, turned
