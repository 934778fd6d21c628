"""A plan starts late; until then the one before it goes on."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter

_SOURCE = "serial link and control loop: a few milliseconds"

EFFECT = Effect(
    regime="gantry",
    law="V(t - delay)",
    rows={"delay_s": Parameter("command_delay", "s", 0.0, 0.0, 0.09, "from a plan's stamp to its start", _SOURCE)},
    depends_on=("command",),
    excited_by="plans that change while the mallet moves, with the encoders' and the plans' clocks in step",
    source="transport delay",
    not_simulated="its plans begin where the mallet is when they are made",
)
