"""Walls rub: a Coulomb impulse that makes the puck spin, and a spin that acts at the next hit."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts.rub import rub

_SOURCE = "0.11 found on a real table; 1/2 is a full disc"

EFFECT = Effect(
    regime="wall",
    law="impulse along = -slip / (1 + 1/kappa), at most mu (1 + e) closing, slip = v_t - r spin; spin' = -decay spin",
    rows={
        "mu": Parameter(
            "wall_mu", "1", 0.0, 0.0, 1.0, "friction of walls and posts; 0: they keep a share instead", _SOURCE
        ),
        "kappa": Parameter(
            "spin_inertia", "1", 0.5, 0.1, 1.0, "moment of inertia over mass and radius squared", _SOURCE
        ),
        "decay": Parameter("spin_decay", "1/s", 0.5, 0.0, 20.0, "rate at which spin dies out between hits", _SOURCE),
    },
    depends_on=("speed", "heading", "history"),
    excited_by="oblique hits, and second hits soon after them",
    source="Stronge, Impact Mechanics, chapter 3",
)


@kernel
def tangent(p, closing, e, along, spin, after):
    """Slip or grip, instead of a share kept."""
    if p.wall_mu <= 0.0:
        return after, spin
    impulse, turned = rub(p.wall_mu, p.spin_inertia, p.puck_radius, (1.0 + e) * closing, along, spin)
    return along + impulse, turned
