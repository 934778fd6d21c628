"""Fast hits lose more at a wall: restitution falls with the normal speed."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "0.864 at 0.5 to 1 m/s and 0.826 above 3 m/s on a real table"

EFFECT = Effect(
    regime="wall",
    law="e = max(0, e0 - slope closing)",
    rows={
        "slope": Parameter(
            "restitution_slope", "s/m", 0.0, -0.1, 0.3, "loss of restitution for each m/s of normal speed", _SOURCE
        ),
    },
    depends_on=("speed",),
    excited_by="wall hits of all speeds",
    source="linear in the normal speed, as fitted on a real table",
)


@kernel
def restitution(p, kind, closing, e):
    """Less the faster it hits; walls and posts alike."""
    return e - p.restitution_slope * closing
