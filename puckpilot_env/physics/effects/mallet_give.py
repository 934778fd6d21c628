"""The driven mallet recoils: it hits with a finite effective mass."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "a documented choice"

EFFECT = Effect(
    regime="mallet",
    law="impulse = (1 + e) closing / (1 + ratio)",
    rows={
        "ratio": Parameter(
            "mallet_give", "1", 0.0, 0.0, 0.5, "mass of the puck over the effective mass of the mallet", _SOURCE
        ),
    },
    depends_on=("speed", "command"),
    excited_by="strikes by a moving and by a waiting mallet",
    source="two masses in collision; the drive is taken to hold the mallet to its path afterwards",
)


@kernel
def mallet_impulse(p, impulse):
    """Less, the lighter the mallet is."""
    return impulse / (1.0 + p.mallet_give)
