"""Unlisted forces on a gliding puck, as examples of effects of a real table that no list anticipates."""

from __future__ import annotations

from math import atan2, cos, exp, pi, sin, sqrt

from puckpilot_env.kernel import kernel


@kernel
def pull(law, t, x, y):
    """Acceleration (ax, ay) [m/s^2] by place and time: a vortex, a washboard, a drifting tilt, a push for a while."""
    since = t - law.tilt_drift_from
    ax, ay = law.tilt_drift_x * since, law.tilt_drift_y * since
    if law.push_from < t < law.push_until:
        ax += law.push_x
        ay += law.push_y
    if law.vortex != 0.0:
        dx, dy = (x - law.vortex_x) / law.vortex_size, (y - law.vortex_y) / law.vortex_size
        round_it = law.vortex * exp(0.5 - 0.5 * (dx * dx + dy * dy))  # r exp((1 - r^2) / 2) is 1 at most, at r = 1
        ax -= round_it * dy
        ay += round_it * dx
    if law.washboard != 0.0:
        ax += law.washboard * sin(2.0 * pi * x / law.washboard_length)
    return ax, ay


@kernel
def rub(law, t, x, y, vx, vy, since, friction):
    """Friction [m/s^2] by time, heading, place, speed and time since the last contact; `friction`: without these."""
    if law.breathing != 0.0:
        friction *= 1.0 + law.breathing * sin(2.0 * pi * t / law.breathing_period)
    if law.pulse != 0.0 and t % law.pulse_period < 0.5 * law.pulse_period:
        friction *= 1.0 + law.pulse
    if (law.grain != 0.0 or law.nap != 0.0) and (vx != 0.0 or vy != 0.0):
        heading = atan2(vy, vx)
        friction *= 1.0 + law.grain * cos(4.0 * heading) + law.nap * cos(heading - law.nap_heading)
    if law.stripe != 0.0 and abs(x - law.stripe_x) < 0.5 * law.stripe_width:
        friction += law.stripe
    if law.slow_friction != 0.0:
        friction += law.slow_friction * exp(-sqrt(vx * vx + vy * vy) / law.slow_speed)
    if law.fading != 0.0:
        friction += law.fading * exp(-since / law.fading_time)
    return friction
