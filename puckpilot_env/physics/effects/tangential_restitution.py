"""The tangential speed keeps a share of its own at a wall."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel

_SOURCE = "a documented choice; 1 is the report's law"

EFFECT = Effect(
    regime="wall",
    law="v_t -> min(1, ratio e0) v_t (ratio 1: as the normal component, whatever slows that)",
    rows={
        "ratio": Parameter(
            "tangential_ratio",
            "1",
            1.0,
            0.0,
            2.0,
            "tangential share kept over wall_restitution; 1: the normal share",
            _SOURCE,
        ),
    },
    depends_on=("heading",),
    excited_by="oblique wall hits",
    source="a constant of its own for the component along the wall",
)


@kernel
def tangent(p, closing, e, along, spin, after):
    """A constant share, at most all, whatever the normal one does; at 1 the tangent keeps what the normal keeps."""
    if p.tangential_ratio == 1.0:
        return after, spin
    return min(p.tangential_ratio * p.wall_restitution, 1.0) * along, spin
