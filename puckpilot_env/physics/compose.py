"""The hooks of all effects as one kernel each, in the order of the effects' names.

An effect's file has the hooks of its regime, every one a kernel; those that it does not have change nothing.

| regime | hook | returns |
| --- | --- | --- |
| glide | `is_on(p)` | whether the record `p` has this effect at all; every effect of the regime has it |
| glide | `acceleration(p, t, x, y, vx, vy, spin)` | (ax, ay) [m/s^2], which is added to that of the others |
| glide | `friction(p, t, x, y, vx, vy, friction)` | friction [m/s^2] from that so far; less than none is none |
| glide | `edge(p, t, x, y, v, t1, x1, y1, v1)` | see below; of a law that jumps or has a kink |
| glide | `stride(p, v)` | how long [s] the law is well told by its values at begin, middle and end; of waves |
| wall, corner | `restitution(p, kind, closing, e)` | restitution from that so far; `kind` as in `bounce` |
| wall | `tangent(p, closing, e, along, spin, after)` | (tangential speed, spin) after it, from the speed so far |
| wall | `shares(p, t, kind, x, y, closing, along)` | (of the normal speed, of the tangential): kept beyond all this |
| wall | `angle(p, kind)` | how far [rad] a wall's normal is turned counter-clockwise; added to that of others |
| mallet | `mallet_restitution(p, closing, e)` | restitution from that so far |
| mallet | `mallet_impulse(p, impulse)` | normal impulse [m/s] from that so far |
| mallet | `mallet_tangent(p, impulse, along, spin, after)` | (tangential speed, spin), relative to the mallet |
| mallet | `mallet_shares(p, t, x, y, closing, along)` | (of the normal speed, of the tangential): kept beyond this |
| sensing | `camera_map(p)` | (xx, xy, yx, yy): how far off x and y are seen for each metre of x and of y |
| gantry | `loses(p)` | whether less arrives at the motors than a plan asks for; goes with the next |
| gantry | `delivered(p, volts, load)` | volts at a motor from those so far; `load` = abs(V_x) + abs(V_y) as asked for |
| gantry | `delay(p)` | how long after its decision a plan starts [s], less than the time between two decisions |
| gantry | `in_pieces(p)` | whether a mallet's path is found piece by piece (see `drivetrain`); goes with the next |
| gantry | `dry_friction(p)` | volts that the left and the right motor, the x and the y axis lose; of one effect alone |
| gantry | `spring(p)` | (angular frequency [rad/s], 0 if rigid; damping ratio) of the belt; of one effect alone |
| gantry | `holds(p)` | how long [s] the next are nearly those half-way, infinite if there are none |
| gantry | `extra_volts(p, t, x, y, vx, vy, volts_x, volts_y)` | (x, y), which are added to the motors' |
| gantry | `gap(p)` | gap [m] between what drags the mallet and the mallet; of one effect alone |

`t` [s] is the time of the episode, (x, y) [m] a place, spin [rad/s] counter-clockwise, `closing` [m/s] > 0 the normal
speed before; the tangent is the normal turned counter-clockwise. Impulses are per unit mass of the puck.

`edge`: the share of the straight way from the time t, the place (x, y) and the speed v [m/s] to t1, (x1, y1) and v1, at
which the law next jumps or has a kink; above 0, infinite if there is none, and it may lie beyond the way's end.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce
from typing import Any

from puckpilot_env.kernel import inner
from puckpilot_env.physics.effects import MODULES

Hook = Callable[..., Any]


def _where_on(name: str, make: Callable[[Hook, Hook], Hook]) -> list[Hook]:
    """The hooks `name` of the glide, each asked only on tables that have its effect: of many effects few are on."""
    return [make(module.is_on, getattr(module, name)) for module in MODULES.values() if hasattr(module, name)]


def _acceleration_where_on(is_on: Hook, acceleration: Hook) -> Hook:
    @inner
    def where_on(p, t, x, y, vx, vy, spin):
        if is_on(p):
            return acceleration(p, t, x, y, vx, vy, spin)
        return 0.0, 0.0

    return where_on


def _friction_where_on(is_on: Hook, friction: Hook) -> Hook:
    @inner
    def where_on(p, t, x, y, vx, vy, so_far):
        return friction(p, t, x, y, vx, vy, so_far) if is_on(p) else so_far

    return where_on


def _hooks(name: str) -> list[Hook]:
    return [getattr(module, name) for module in MODULES.values() if hasattr(module, name)]


def _either(first: Hook, second: Hook) -> Hook:
    @inner
    def either(p):
        return first(p) or second(p)

    return either


def _sum(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, t, x, y, vx, vy, spin):
        ax, ay = first(p, t, x, y, vx, vy, spin)
        bx, by = second(p, t, x, y, vx, vy, spin)
        return ax + bx, ay + by

    return both


def _friction(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, t, x, y, vx, vy, friction):
        return second(p, t, x, y, vx, vy, first(p, t, x, y, vx, vy, friction))

    return both


def _edge_where_on(is_on: Hook, edge: Hook) -> Hook:
    @inner
    def where_on(p, t, x, y, v, t1, x1, y1, v1):
        return edge(p, t, x, y, v, t1, x1, y1, v1) if is_on(p) else math.inf

    return where_on


def _edge(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, t, x, y, v, t1, x1, y1, v1):
        return min(first(p, t, x, y, v, t1, x1, y1, v1), second(p, t, x, y, v, t1, x1, y1, v1))

    return both


def _stride_where_on(is_on: Hook, stride: Hook) -> Hook:
    @inner
    def where_on(p, v):
        return stride(p, v) if is_on(p) else math.inf

    return where_on


def _stride(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, v):
        return min(first(p, v), second(p, v))

    return both


def _restitution(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, kind, closing, e):
        return second(p, kind, closing, first(p, kind, closing, e))

    return both


def _tangent(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, closing, e, along, spin, after):
        after, turned = first(p, closing, e, along, spin, after)
        return second(p, closing, e, along, turned, after)

    return both


def _shares(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, t, kind, x, y, closing, along):
        normal, tangential = first(p, t, kind, x, y, closing, along)
        more, more_along = second(p, t, kind, x, y, closing, along)
        return normal + more, tangential + more_along

    return both


def _sum_of_kind(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, kind):
        return first(p, kind) + second(p, kind)

    return both


def _mallet_restitution(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, closing, e):
        return second(p, closing, first(p, closing, e))

    return both


def _mallet_impulse(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, impulse):
        return second(p, first(p, impulse))

    return both


def _mallet_tangent(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, impulse, along, spin, after):
        after, turned = first(p, impulse, along, spin, after)
        return second(p, impulse, along, turned, after)

    return both


def _mallet_shares(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, t, x, y, closing, along):
        normal, tangential = first(p, t, x, y, closing, along)
        more, more_along = second(p, t, x, y, closing, along)
        return normal + more, tangential + more_along

    return both


def _camera_map(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p):
        a, b = first(p), second(p)
        return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]

    return both


def _delay(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p):
        return first(p) + second(p)

    return both


def _delivered(first: Hook, second: Hook) -> Hook:
    @inner
    def both(p, volts, load):
        return second(p, first(p, volts, load), load)

    return both


is_forced = reduce(_either, _hooks("is_on"))
acceleration = reduce(_sum, _where_on("acceleration", _acceleration_where_on))
friction = reduce(_friction, _where_on("friction", _friction_where_on))
edge = reduce(_edge, _where_on("edge", _edge_where_on))
has_edges = reduce(_either, [module.is_on for module in MODULES.values() if hasattr(module, "edge")])
stride = reduce(_stride, _where_on("stride", _stride_where_on))
restitution = reduce(_restitution, _hooks("restitution"))
tangent = reduce(_tangent, _hooks("tangent"))
shares = reduce(_shares, _hooks("shares"))
angle = reduce(_sum_of_kind, _hooks("angle"))
mallet_restitution = reduce(_mallet_restitution, _hooks("mallet_restitution"))
mallet_impulse = reduce(_mallet_impulse, _hooks("mallet_impulse"))
mallet_tangent = reduce(_mallet_tangent, _hooks("mallet_tangent"))
mallet_shares = reduce(_mallet_shares, _hooks("mallet_shares"))
camera_map = reduce(_camera_map, _hooks("camera_map"))
loses = reduce(_either, _hooks("loses"))
delivered = reduce(_delivered, _hooks("delivered"))
delay = reduce(_delay, _hooks("delay"))
in_pieces = reduce(_either, _hooks("in_pieces"))
(dry_friction,) = _hooks("dry_friction")
(spring,) = _hooks("spring")
(gap,) = _hooks("gap")
(holds,) = _hooks("holds")
(extra_volts,) = _hooks("extra_volts")
