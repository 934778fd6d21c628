"""A mallet hits the puck, perhaps against a wall, a post or the other mallet."""

from __future__ import annotations

from puckpilot_env.kernel import kernel
from puckpilot_env.physics.contacts import bounce, contact, rebound
from puckpilot_env.physics.gantry.mallet import halt, motion_at, push_at
from puckpilot_env.physics.hand import is_by_hand
from puckpilot_env.physics.sliding.support import stands
from puckpilot_env.physics.vector import size


@kernel
def _other_obstacle(puck, p, mallets, k, t, nx, ny):
    """`(mallet, wx, wy, ox, oy)` of what the puck also touches, most opposite `n`; mallet is -1: a wall, -2: none."""
    kind, wx, wy = bounce.touched(
        puck.x, puck.y, nx, ny, contact.PINCH_SLACK, p.length, p.width, p.goal_width, p.puck_radius
    )
    other = 1 - k
    mx, my, ox, oy = motion_at(mallets[other], t)
    dx, dy = puck.x - mx, puck.y - my
    apart = size(dx, dy)
    opposed = min(wx * nx + wy * ny, 0.0) * apart
    if apart - p.puck_radius - p.mallet_radius < contact.PINCH_SLACK and dx * nx + dy * ny < opposed:
        return other, dx / apart, dy / apart, ox, oy
    return (-2 if kind == bounce.NOTHING else -1), wx, wy, 0.0, 0.0


@kernel
def _leans(mallet, t, leaving, pull):
    """Whether the forces alone, `pull` [m/s^2] along the normal, press a puck on a mallet at rest: so slow are both
    that nothing squeezes the puck. `leaving` [m/s] is the puck's speed along the normal."""
    return -leaving < -pull * contact.REST_BETWEEN_TOUCHES and stands(mallet, t)


@kernel
def closes_on(puck, vx, vy, p, mallet, t):
    """Whether a puck of velocity `v` that touches this mallet runs into it."""
    mx, my, mvx, mvy = motion_at(mallet, t)
    dx, dy = puck.x - mx, puck.y - my
    touching = size(dx, dy) - p.puck_radius - p.mallet_radius < contact.PINCH_SLACK
    return touching and (vx - mvx) * dx + (vy - mvy) * dy < 0.0


@kernel
def hit(puck, p, mallets, k, clock, t, ax, ay):
    """Apply the impulse of player `k`'s mallet at `t`, seeing to it that no puck is driven through anything.

    `clock` [s]: the time of the episode when the plans began; `a` [m/s^2]: what the effects' forces do to the puck.
    """
    puck.touched[k] = 1
    mx, my, mvx, mvy = motion_at(mallets[k], t)
    dx, dy = puck.x - mx, puck.y - my
    apart = size(dx, dy)
    nx, ny = dx / apart, dy / apart
    push = push_at(mallets[k], t, nx, ny) + max(-(ax * nx + ay * ny), 0.0)
    before_x, before_y = puck.vx, puck.vy
    if is_by_hand(puck, p, k):
        puck.vx, puck.vy = contact.reflect(puck.vx, puck.vy, mvx, mvy, nx, ny, p.mallet_restitution)
    else:
        rebound.strike(puck, p, clock + t, mvx, mvy, nx, ny)
    vx, vy = contact.part(puck.vx, puck.vy, mvx, mvy, nx, ny, push, p.friction, p.drag)
    other, wx, wy, ox, oy = _other_obstacle(puck, p, mallets, k, t, nx, ny)
    if _leans(mallets[k], t, before_x * nx + before_y * ny, ax * nx + ay * ny):
        other = -2
    if other != -2 and (vx - ox) * wx + (vy - oy) * wy < 0.0:
        separation = (vx - mvx) * nx + (vy - mvy) * ny
        impulse = separation + (mvx - before_x) * nx + (mvy - before_y) * ny
        held, vx, vy = contact.pinch(  # which the mallet's rim has rubbed already, but not pushed
            vx - impulse * nx, vy - impulse * ny, mvx, mvy, nx, ny, ox, oy, wx, wy, separation, p.wall_restitution
        )
        third, tx, ty = bounce.touched(
            puck.x, puck.y, vx, vy, contact.PINCH_SLACK, p.length, p.width, p.goal_width, p.puck_radius
        )
        jammed = third != bounce.NOTHING and (tx * wx + ty * wy) < 0.99
        if other == -1 and not jammed and closes_on(puck, vx, vy, p, mallets[1 - k], t):
            other, jammed = 1 - k, True
        if held or jammed:
            halt(mallets[k], t)
            if other >= 0:
                halt(mallets[other], t)
            if not held:
                vx, vy = 0.0, 0.0
    if vx * vx + vy * vy > contact.SQUEEZED_SPEED * contact.SQUEEZED_SPEED:
        halt(mallets[0], t)
        halt(mallets[1], t)
        vx, vy = 0.0, 0.0
    puck.vx, puck.vy = vx, vy
