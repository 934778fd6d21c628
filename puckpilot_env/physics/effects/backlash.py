"""Lost motion: at a reversal the motor moves through a gap before the mallet follows."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "worn pulleys and slack belts: tenths of a millimetre to some millimetres"

EFFECT = Effect(
    regime="gantry",
    law="the mallet stays where it is while the motor is within gap/2 of it",
    rows={"gap": Parameter("backlash_gap", "m", 0.0, 0.0, 0.02, "lost motion at a reversal of an axis", _SOURCE)},
    depends_on=("history",),
    excited_by="many reversals of each axis",
    source="play operator",
)


@kernel
def carried(gap, mallet, motor):
    """Where the mallet is [m] when the motor's side has come to `motor` [m]; it was at `mallet` before."""
    return min(max(mallet, motor - 0.5 * gap), motor + 0.5 * gap)


@kernel
def in_pieces(p):
    """Whether there is play, which a plan takes up on its way."""
    return p.backlash_gap > 0.0


@kernel
def gap(p):
    """The gap [m]."""
    return p.backlash_gap
