"""A force with edges that no other effect says: a push or a brake inside a span of time, or of x, or of y.

`kind` says of what the span is: 1 of time [s], 2 of x [m], 3 of y [m]. A span of time may come again and again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.interpolation import next_knot, share_of_time

OF_TIME, OF_X, OF_Y = range(1, 4)
_SOURCE = "found by a diagnosis; no table is known to have it"
_LATEST = 1e4  # s, the end of a recording of three hours
STRONGEST = 5.0  # m/s^2, half of gravity


def misfit(numbers: Mapping[str, float]) -> str:
    """Of which numbers no span can be made."""
    begin, end, every = (numbers[name] for name in ("from", "until", "every"))
    if numbers["kind"] and not begin < end:
        return f"it lasts from {begin:g} until {end:g}; expected an end after the beginning"
    if numbers["kind"] == OF_TIME and every and every <= end - begin:
        return f"it comes every {every:g} s and lasts {end - begin:g} s; expected a shorter one"
    if every and numbers["kind"] != OF_TIME:
        return f"it comes every {every:g} s, but is not of time; expected kind {OF_TIME}"
    return ""


EFFECT = Effect(
    regime="glide",
    law="a = push, f = friction + brake, inside a span of time, x or y",
    rows={
        "kind": Parameter(
            "window_kind", "1", 0.0, 0.0, 3.0, "of what the span is: 1 time, 2 x, 3 y; 0: no force", _SOURCE, whole=True
        ),
        "from": Parameter("window_from", "SI", 0.0, -_LATEST, _LATEST, "where the span begins [s or m]", _SOURCE),
        "until": Parameter("window_until", "SI", 0.0, -_LATEST, _LATEST, "where it ends [s or m]", _SOURCE),
        "every": Parameter(
            "window_every", "s", 0.0, 0.0, _LATEST, "how long after a beginning the next comes; 0: once", _SOURCE
        ),
        "push_x": Parameter("window_push_x", "m/s^2", 0.0, -STRONGEST, STRONGEST, "force along x inside", _SOURCE),
        "push_y": Parameter("window_push_y", "m/s^2", 0.0, -STRONGEST, STRONGEST, "force along y inside", _SOURCE),
        "brake": Parameter(
            "window_brake", "m/s^2", 0.0, -STRONGEST, STRONGEST, "friction inside less that outside", _SOURCE
        ),
    },
    depends_on=("time", "position"),
    excited_by="glides before, inside and after the span",
    source="sharp edges, as far as a recording can tell them from smooth ones",
    listed=False,
    misfit=misfit,
)


@kernel
def is_on(p):
    """Whether there is such a force."""
    return p.window_kind != 0.0


@kernel
def is_inside(p, t, x, y):
    """Whether the puck is inside the span."""
    if p.window_kind == OF_TIME:
        since = t - p.window_from
        if p.window_every > 0.0:
            since %= p.window_every
        return 0.0 <= since < p.window_until - p.window_from
    s = x if p.window_kind == OF_X else y
    return p.window_from <= s < p.window_until


@kernel
def acceleration(p, t, x, y, vx, vy, spin):
    """The push."""
    if is_inside(p, t, x, y):
        return p.window_push_x, p.window_push_y
    return 0.0, 0.0


@kernel
def friction(p, t, x, y, vx, vy, friction):
    """With the brake."""
    return friction + p.window_brake if is_inside(p, t, x, y) else friction


@kernel
def edge(p, t, x, y, v, t1, x1, y1, v1):
    """The span's next beginning or end."""
    if p.window_kind == OF_TIME:
        return (_next_edge(p, t) - t) / (t1 - t)
    span = (p.window_from, p.window_until)
    way = next_knot(x, x1, span) if p.window_kind == OF_X else next_knot(y, y1, span)
    return share_of_time(way, v, v1)


@kernel
def _next_edge(p, t):
    """The time [s] of the next beginning or end after `t`."""
    begin = p.window_from
    if p.window_every > 0.0:
        begin += p.window_every * math.floor((t - begin) / p.window_every)
    end = begin + p.window_until - p.window_from
    if t < begin:
        return begin
    if t < end:
        return end
    return begin + p.window_every if p.window_every > 0.0 else math.inf
