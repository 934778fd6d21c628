"""Fast strikes lose more at a mallet: its restitution falls with the closing speed."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "a documented choice"

EFFECT = Effect(
    regime="mallet",
    law="e = max(0, e0 - slope closing)",
    rows={
        "slope": Parameter(
            "mallet_restitution_slope",
            "s/m",
            0.0,
            -0.1,
            0.3,
            "loss of restitution for each m/s of closing speed",
            _SOURCE,
        ),
    },
    depends_on=("speed",),
    excited_by="strikes of all speeds",
    source="linear in the closing speed",
)


@kernel
def mallet_restitution(p, closing, e):
    """Less the faster they close."""
    return e - p.mallet_restitution_slope * closing
