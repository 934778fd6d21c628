"""The hooks of all effects as one kernel each, in the order of the effects' names.

An effect's file has the hooks of its regime, every one a kernel; those that it does not have change nothing.

| regime | hook | returns |
| --- | --- | --- |
| glide | `is_on(p)` | whether the record `p` has this effect at all; every effect of the regime has it |
| glide | `acceleration(p, t, x, y, vx, vy, spin)` | (ax, ay) [m/s^2], which is added to that of the others |
| glide | `friction(p, t, x, y, dx, dy, friction)` | friction [m/s^2] from that so far: its mean over the way (dx, dy) |
| wall, corner | `restitution(p, kind, closing, e)` | restitution from that so far; `kind` as in `bounce` |
| wall | `tangent(p, closing, e, along, spin, after)` | (tangential speed, spin) after it, from the speed so far |
| wall | `shares(p, t, kind, x, y, closing, along)` | (of the normal speed, of the tangential): kept beyond all this |
| mallet | `mallet_restitution(p, closing, e)` | restitution from that so far |
| mallet | `mallet_impulse(p, impulse)` | normal impulse [m/s] from that so far |
| mallet | `mallet_tangent(p, impulse, along, spin, after)` | (tangential speed, spin), relative to the mallet |
| mallet | `mallet_shares(p, t, x, y, closing, along)` | (of the normal speed, of the tangential): kept beyond this |
| sensing | `camera_map(p)` | (xx, xy, yx, yy): how far off x and y are seen for each metre of x and of y |
| gantry | `loses(p)` | whether less arrives at the motors than a plan asks for; goes with the next |
| gantry | `delivered(p, volts, load)` | volts at a motor from those so far; `load` = abs(V_x) + abs(V_y) as asked for |
| gantry | `delay(p)` | how long after its decision a plan starts [s], less than the time between two decisions |

`t` [s] is the time of the episode, (x, y) [m] a place, spin [rad/s] counter-clockwise, `closing` [m/s] > 0 the normal
speed before; the tangent is the normal turned counter-clockwise. Impulses are per unit mass of the puck.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from typing import Any

from puckpilot_env.kernel import inner
from puckpilot_env.physics.effects import MODULES

Hook = Callable[..., Any]


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
    def both(p, t, x, y, dx, dy, friction):
        return second(p, t, x, y, dx, dy, first(p, t, x, y, dx, dy, friction))

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
acceleration = reduce(_sum, _hooks("acceleration"))
friction = reduce(_friction, _hooks("friction"))
restitution = reduce(_restitution, _hooks("restitution"))
tangent = reduce(_tangent, _hooks("tangent"))
shares = reduce(_shares, _hooks("shares"))
mallet_restitution = reduce(_mallet_restitution, _hooks("mallet_restitution"))
mallet_impulse = reduce(_mallet_impulse, _hooks("mallet_impulse"))
mallet_tangent = reduce(_mallet_tangent, _hooks("mallet_tangent"))
mallet_shares = reduce(_mallet_shares, _hooks("mallet_shares"))
camera_map = reduce(_camera_map, _hooks("camera_map"))
loses = reduce(_either, _hooks("loses"))
delivered = reduce(_delivered, _hooks("delivered"))
delay = reduce(_delay, _hooks("delay"))
