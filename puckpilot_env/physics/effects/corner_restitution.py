"""Goal posts bounce unlike the walls."""

from __future__ import annotations

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce

_SOURCE = "a documented choice"

EFFECT = Effect(
    regime="corner",
    law="e = e0 + extra at a post",
    rows={
        "extra": Parameter(
            "post_extra", "1", 0.0, -0.9, 0.5, "restitution of the goal posts less that of the walls", _SOURCE
        ),
    },
    depends_on=("position",),
    excited_by="shots that hit the goal posts",
    source="a documented choice: a constant",
)


@kernel
def restitution(p, kind, closing, e):
    """Another constant at the posts."""
    return e + p.post_extra if kind == bounce.POST else e
