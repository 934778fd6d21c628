"""A glide carried on beyond its frames, to a contact that nobody saw: a beam may hide what happens for a tenth of a
second, in which a fast puck's brake changes."""

from __future__ import annotations

import numpy as np

STEP = 0.01  # s, at most, of the Runge-Kutta method of fourth order
AT_REST = 1e-6  # m/s, below which a puck has no heading


def braking(velocity: np.ndarray, friction: float, drag: float) -> np.ndarray:
    """Acceleration (…, 2) [m/s^2] of the report's law, a = -(friction + drag v^2) along the velocity (…, 2) [m/s]."""
    speed = np.linalg.norm(velocity, axis=-1, keepdims=True)
    return -(friction + drag * speed**2) * velocity / np.maximum(speed, AT_REST)


def carried(
    place: np.ndarray, velocity: np.ndarray, beyond: np.ndarray, friction: float, drag: float, duration: float
) -> tuple[np.ndarray, np.ndarray]:
    """Place and velocity (2,) `duration` [s] later, or earlier where it is negative, under `braking` and a constant
    acceleration `beyond` (2,) [m/s^2]."""
    steps = max(int(np.ceil(abs(duration) / STEP)), 1)
    h = duration / steps
    for _ in range(steps):
        v, a = [velocity], [braking(velocity, friction, drag) + beyond]
        for part in (0.5, 0.5, 1.0):
            v.append(velocity + part * h * a[-1])
            a.append(braking(v[-1], friction, drag) + beyond)
        place = place + h / 6.0 * (v[0] + 2.0 * v[1] + 2.0 * v[2] + v[3])
        velocity = velocity + h / 6.0 * (a[0] + 2.0 * a[1] + 2.0 * a[2] + a[3])
    return place, velocity
