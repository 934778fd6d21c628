"""The supply sags under load: the more volts both axes ask for, the less of them arrives."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "internal resistance of a supply; 0.02 1/V loses a quarter at 16 V"

EFFECT = Effect(
    regime="gantry",
    law="V / (1 + sag (|V_x| + |V_y|))",
    rows={"sag": Parameter("voltage_sag", "1/V", 0.0, 0.0, 0.2, "loss of voltage with the volts asked for", _SOURCE)},
    depends_on=("command",),
    excited_by="moves of both axes at once, with volts from a few to all there are",
    source="a source with internal resistance",
)


@kernel
def loses(p):
    """Whether the supply sags."""
    return p.voltage_sag != 0.0


@kernel
def delivered(p, volts, load):
    """What arrives [V] of `volts` while both axes together ask for `load` = |V_x| + |V_y| [V]."""
    return volts / (1.0 + p.voltage_sag * load)
