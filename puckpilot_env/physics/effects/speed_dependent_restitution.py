"""Fast hits lose more at a wall: restitution falls with the normal speed."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "0.864 at 0.5 to 1 m/s and 0.826 above 3 m/s on a real table"
_POWER = "viscoelastic and plastic impacts lose by small powers of the speed, e.g. 1/5 and 1/4"

EFFECT = Effect(
    regime="wall",
    law="e = max(0, e0 closing^-exponent - slope closing)",
    rows={
        "slope": Parameter(
            "restitution_slope", "s/m", 0.0, -0.1, 0.3, "loss of restitution for each m/s of normal speed", _SOURCE
        ),
        "exponent": Parameter(
            "restitution_power", "1", 0.0, -1.0, 1.0, "restitution goes with this negative power of the speed", _POWER
        ),
    },
    depends_on=("speed",),
    excited_by="wall hits of all speeds",
    source="linear in the normal speed in m/s, as fitted on a real table, or by a power of it",
)


@kernel
def restitution(p, kind, closing, e):
    """Less the faster it hits; walls and posts alike. No more than 1 by the power, which is endless at rest."""
    if p.restitution_power != 0.0 and closing > 0.0:
        e = min(1.0, e * closing**-p.restitution_power)
    return e - p.restitution_slope * closing
