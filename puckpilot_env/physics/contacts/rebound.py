"""What a wall, a post or a mallet does to the puck's velocity and spin: the baseline's law, and the effects on it.

Where no effect changes anything, the result is the baseline's to the last digit.
"""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.contacts import bounce, contact


@kernel
def wall_restitution(p, kind, closing, turned):
    """Restitution of a wall or post (`kind` as in `bounce`) at a normal speed `closing` [m/s]; from 0 to 1."""
    if turned != 0:
        kind = bounce.opposite(kind)
    return min(max(compose.restitution(p, kind, closing, p.wall_restitution), 0.0), 1.0)


@kernel
def kept_beyond(before, after, more):
    """What a speed [m/s], `before` a contact and `after` it, gains by a further share of it that is kept: `more`, but
    that turns no speed round and adds none."""
    least, most = min(after, min(before, 0.0)), max(after, max(before, 0.0))
    return min(max(after + more * before, least), most) - after


@kernel
def kept_along(p, before, after, spin, turned, more):
    """`kept_beyond` of the speed along a contact that also turns `spin` [rad/s] into `turned`: motion and spin have no
    more energy than before it."""
    radius2 = p.spin_inertia * p.puck_radius * p.puck_radius
    most = math.sqrt(max(before * before + radius2 * (spin * spin - turned * turned), after * after))
    return min(max(after + kept_beyond(before, after, more), -most), most) - after


@kernel
def kick(puck, nx, ny, gain, rub):
    """Add `gain` [m/s] along the normal and `rub` along the tangent to a puck's velocity."""
    puck.vx, puck.vy = puck.vx + gain * nx - rub * ny, puck.vy + gain * ny + rub * nx


@kernel
def more_shares(puck, p, t, kind, closing, along):
    """Shares of the normal and of the tangential speed that are kept beyond what restitution and friction leave."""
    if puck.turned == 0:
        return compose.shares(p, t, kind, puck.x, puck.y, closing, along)
    return compose.shares(p, t, bounce.opposite(kind), p.length - puck.x, p.width - puck.y, closing, along)


@kernel
def rebound(puck, p, t, kind, nx, ny):
    """Let a puck bounce off a wall or post (`kind` as in `bounce`), of unit normal `n` towards the puck, in place.

    `t` [s] is the time of the episode. Off a wall that is turned it goes no deeper into the straight one.
    """
    angle = compose.angle(p, kind if puck.turned == 0 else bounce.opposite(kind))
    if angle == 0.0:
        rebound_off(puck, p, t, kind, nx, ny)
        return
    c, s = math.cos(angle), math.sin(angle)
    rebound_off(puck, p, t, kind, c * nx - s * ny, s * nx + c * ny)
    out = puck.vx * nx + puck.vy * ny
    if out < 0.0:
        puck.vx, puck.vy = puck.vx - out * nx, puck.vy - out * ny


@kernel
def rebound_off(puck, p, t, kind, nx, ny):
    """`rebound` off a surface of unit normal `n`."""
    closing = -(puck.vx * nx + puck.vy * ny)
    if closing <= bounce.SLIDING:
        puck.vx, puck.vy = bounce.reflect(puck.vx, puck.vy, nx, ny, p.wall_restitution)
        return
    e = wall_restitution(p, kind, closing, puck.turned)
    along = puck.vy * nx - puck.vx * ny
    kept = e * along
    spin = puck.spin
    after, puck.spin = compose.tangent(p, closing, e, along, spin, kept)
    puck.vx, puck.vy = bounce.reflect(puck.vx, puck.vy, nx, ny, e)
    if after != kept:
        puck.vx, puck.vy = puck.vx - (after - kept) * ny, puck.vy + (after - kept) * nx
    more, more_along = more_shares(puck, p, t, kind, closing, along)
    if more != 0.0 or more_along != 0.0:
        further = kept_along(p, along, after, spin, puck.spin, more_along)
        kick(puck, nx, ny, kept_beyond(closing, e * closing, more), further)


@kernel
def more_shares_past_mallet(puck, p, t, closing, along):
    """The same of the speeds past a mallet."""
    if puck.turned == 0:
        return compose.mallet_shares(p, t, puck.x, puck.y, closing, along)
    return compose.mallet_shares(p, t, p.length - puck.x, p.width - puck.y, closing, along)


@kernel
def strike(puck, p, t, mx, my, nx, ny):
    """Let a puck bounce off a mallet of velocity `m` [m/s], of unit normal `n` towards the puck, in place.

    `t` [s] is the time of the episode. The mallet keeps to its path: its drive makes up for what the puck gives it.
    """
    vx, vy = puck.vx - mx, puck.vy - my
    closing = -(vx * nx + vy * ny)
    if closing <= 0.0:
        return
    e = min(max(compose.mallet_restitution(p, closing, p.mallet_restitution), 0.0), 1.0)
    plain = (1.0 + e) * closing
    impulse = compose.mallet_impulse(p, plain)
    along = vy * nx - vx * ny
    spin = puck.spin
    after, puck.spin = compose.mallet_tangent(p, impulse, along, spin, along)
    puck.vx, puck.vy = contact.reflect(puck.vx, puck.vy, mx, my, nx, ny, e)
    if impulse != plain or after != along:
        kick(puck, nx, ny, impulse - plain, after - along)
    more, more_along = more_shares_past_mallet(puck, p, t, closing, along)
    if more != 0.0 or more_along != 0.0:
        further = kept_along(p, along, after, spin, puck.spin, more_along)
        kick(puck, nx, ny, kept_beyond(closing, impulse - closing, more), further)
