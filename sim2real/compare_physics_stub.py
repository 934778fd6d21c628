"""Stand-ins for puckpilot_env.physics.{glide, bounce, contact}, with their call signatures; to be deleted."""

from __future__ import annotations

import math
from types import SimpleNamespace


def _speed(v0: float, t: float, friction: float, drag: float) -> float:
    """Speed [m/s] at `t` of a puck that slides under s'' = -friction - drag s'^2 (report, equation 6)."""
    if v0 <= 0.0 or friction <= 0.0:
        return max(v0, 0.0) / (1.0 + drag * max(v0, 0.0) * t)
    if drag <= 0.0:
        return max(v0 - friction * t, 0.0)
    root = math.sqrt(drag * friction)
    angle = math.atan(v0 * math.sqrt(drag / friction)) - root * t
    return math.sqrt(friction / drag) * math.tan(angle) if angle > 0.0 else 0.0


def _distance(v0: float, t: float, friction: float, drag: float) -> float:
    """Distance [m] slid until `t` (report, equations 7-9), at rest after it has stopped."""
    v1 = _speed(v0, t, friction, drag)
    if drag <= 0.0:
        return v0 * t if friction <= 0.0 else (v0 * v0 - v1 * v1) / (2.0 * friction)
    if friction <= 0.0:
        return math.log1p(drag * max(v0, 0.0) * t) / drag
    return math.log((friction + drag * v0 * v0) / (friction + drag * v1 * v1)) / (2.0 * drag)


def _reflect(vx: float, vy: float, nx: float, ny: float, restitution: float) -> tuple[float, float]:
    """Velocity after a wall with the normal n: both components keep `restitution` (report, equation 10)."""
    vn = vx * nx + vy * ny
    return restitution * (vx - 2.0 * vn * nx), restitution * (vy - 2.0 * vn * ny)


def _reflect_off_mallet(vx, vy, mx, my, nx, ny, restitution) -> tuple[float, float]:
    """Velocity after a driven mallet of velocity m, normal n from mallet to puck: the relative normal part turns."""
    closing = (vx - mx) * nx + (vy - my) * ny
    push = (1.0 + restitution) * closing
    return vx - push * nx, vy - push * ny


glide = SimpleNamespace(distance=_distance, speed=_speed)
bounce = SimpleNamespace(reflect=_reflect)
contact = SimpleNamespace(reflect=_reflect_off_mallet)
