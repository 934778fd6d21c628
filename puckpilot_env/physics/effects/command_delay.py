"""A plan starts late; until then the one before it goes on.

The plan is made from where the mallet is at the decision, as if it began there.
"""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import inner

_SOURCE = "serial link and control loop: a few milliseconds"

EFFECT = Effect(
    regime="gantry",
    law="V(t - delay)",
    rows={"delay_s": Parameter("command_delay", "s", 0.0, 0.0, 0.09, "from a plan's stamp to its start", _SOURCE)},
    depends_on=("command",),
    excited_by="plans that change while the mallet moves, with the encoders' and the plans' clocks in step",
    source="transport delay",
)


@inner
def delay(p):
    """How long after its decision a plan starts [s]."""
    return p.command_delay
